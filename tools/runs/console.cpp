#include "tools/runs/console.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace photorque {
namespace {

std::string superscript(int number) {
  static const char* const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = number < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(number))) text += digits[c - '0'];
  return text;
}

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", std::clamp(decimals, 0, 15), value);
  return text;
}

int magnitude(double value) {
  return static_cast<int>(std::floor(std::log10(std::abs(value))));
}

}  // namespace

Console::Console(const CommandLine& line)
    : silent_(line.quiet || line.json),
      bar_(!silent_ && ::isatty(STDERR_FILENO) != 0),
      last_(std::chrono::steady_clock::now()) {}

void Console::line(const std::string& text) const {
  if (!silent_) std::printf("%s\n", text.c_str());
}

void Console::heading(const std::string& text) const {
  line();
  line(text);
}

std::function<void(double)> Console::progress(const std::string& what) {
  if (!bar_) return {};
  return [this, what](double fraction) {
    const std::scoped_lock lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100) && fraction < 1.0) return;
    last_ = now;
    constexpr int width = 30;
    const int filled = static_cast<int>(std::lround(width * fraction));
    std::string bar;
    for (int i = 0; i < width; ++i) bar += i < filled ? "█" : "·";
    std::fprintf(stderr, "\r%s %s %3.0f %%\033[K", what.c_str(), bar.c_str(), 100.0 * fraction);
    std::fflush(stderr);
  };
}

void Console::note_progress(const std::string& text) {
  if (silent_ || bar_) return;
  const std::scoped_lock lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::seconds(10)) return;
  last_ = now;
  std::fprintf(stderr, "%s\n", text.c_str());
}

void Console::done() {
  if (bar_) std::fprintf(stderr, "\r\033[K");
}

std::string show(double value) {
  if (!std::isfinite(value)) return "not a number";
  if (value == 0.0) return "0";
  const int exponent = magnitude(value);
  if (exponent >= -3 && exponent < 6) {
    std::string text = fixed(value, 5 - exponent);
    if (text.find('.') != std::string::npos) {
      text.erase(text.find_last_not_of('0') + 1);
      if (text.back() == '.') text.pop_back();
    }
    return text;
  }
  return fixed(value / std::pow(10.0, exponent), 4) + "×10" + superscript(exponent);
}

std::string show(const Estimate& estimate, const std::string& unit) {
  const double error = estimate.standard_error;
  if (std::isinf(error)) return show(estimate.value) + " " + unit + " (undetermined)";
  if (!(error > 0.0)) return show(estimate.value) + " " + unit;
  // Two digits of the error decide how many of the value mean something.
  const int last = magnitude(error) - 1;
  const double largest = std::max(std::abs(estimate.value), error);
  const int exponent = magnitude(largest);
  if (exponent >= -3 && exponent < 6 && last > -8) {
    return fixed(estimate.value, -last) + " ± " + fixed(error, -last) + " " + unit;
  }
  const double scale = std::pow(10.0, exponent);
  const int decimals = exponent - last;
  return "(" + fixed(estimate.value / scale, decimals) + " ± " + fixed(error / scale, decimals) +
         ")×10" + superscript(exponent) + " " + unit;
}

std::string show_percent(double fraction) {
  return show(100.0 * fraction) + " %";
}

std::string padded(std::string text, size_t width) {
  const auto letters = static_cast<size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
  return letters < width ? text + std::string(width - letters, ' ') : text + " ";
}

}  // namespace photorque
