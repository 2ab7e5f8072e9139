#include "tools/commands/terminal.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>

namespace photorque {
namespace {

// Says at most so often that something is due.
class Pace {
 public:
  explicit Pace(std::chrono::milliseconds least) : least_(least) {}
  bool due(bool always = false) {
    const std::scoped_lock lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < least_ && !always) return false;
    last_ = now;
    return true;
  }

 private:
  std::mutex mutex_;
  std::chrono::milliseconds least_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void draw_bar(const std::string& what, double fraction) {
  constexpr int width = 30;
  const int filled = static_cast<int>(std::lround(width * fraction));
  std::string bar;
  for (int i = 0; i < width; ++i) bar += i < filled ? "█" : "·";
  std::fprintf(stderr, "\r%s %s %3.0f %%\033[K", what.c_str(), bar.c_str(), 100.0 * fraction);
  std::fflush(stderr);
}

}  // namespace

Console terminal(const CommandLine& line) {
  if (line.quiet || line.json) return Console();
  ConsoleSinks sinks;
  // At once, also into a pipe: a program may wait for the line that says where a run listens.
  sinks.line = [](const std::string& text) {
    std::printf("%s\n", text.c_str());
    std::fflush(stdout);
  };
  if (::isatty(STDERR_FILENO) != 0) {
    const auto pace = std::make_shared<Pace>(std::chrono::milliseconds(100));
    sinks.progress = [pace](const std::string& what, double fraction) {
      if (pace->due(fraction >= 1.0)) draw_bar(what, fraction);
    };
    sinks.done = [] { std::fprintf(stderr, "\r\033[K"); };
  } else {
    const auto pace = std::make_shared<Pace>(std::chrono::seconds(10));
    sinks.note = [pace](const std::string& text) {
      if (pace->due()) std::fprintf(stderr, "%s\n", text.c_str());
    };
  }
  return Console(std::move(sinks));
}

}  // namespace photorque
