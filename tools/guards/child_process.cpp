#include "tools/guards/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "core/errors.h"

namespace photorque {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What a process has used so far; 0 when it is gone.
double processor_time_s(pid_t process) {
  clockid_t clock;
  timespec used = {};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0.0;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

pid_t start(const std::filesystem::path& program, const std::vector<std::string>& arguments,
            const std::filesystem::path& in, const std::filesystem::path& errors) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addchdir_np(&actions, in.c_str());
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = -1;
  // This program's threads block the signals that end it (see Interruption); the child decides
  // anew.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int failed =
      posix_spawn(&child, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw NumericalError("cannot start " + program.string());
  return child;
}

}  // namespace

ChildResult run_child(const std::filesystem::path& program,
                      const std::vector<std::string>& arguments, const std::filesystem::path& in,
                      double max_processor_s) {
  const auto folder = std::filesystem::absolute(in);
  const auto errors = folder / "stderr.txt";
  const Clock::time_point begin = Clock::now();
  const pid_t child = start(program, arguments, folder, errors);
  ChildResult result;
  constexpr double most_idle = 30.0;
  int status = 0;
  rusage used = {};
  while (wait4(child, &status, WNOHANG, &used) == 0) {
    if (processor_time_s(child) > max_processor_s || since(begin) > most_idle * max_processor_s) {
      kill(child, SIGKILL);
      wait4(child, &status, 0, &used);
      result.errors = "stopped after " + std::to_string(static_cast<int>(max_processor_s)) + " s\n";
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  result.processor_s = seconds(used.ru_utime) + seconds(used.ru_stime);
  if (WIFEXITED(status)) result.status = WEXITSTATUS(status);
  std::ifstream in_file(errors);
  std::string text(4096, '\0');
  in_file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(in_file.gcount()));
  result.errors += text;
  std::error_code ignored;
  std::filesystem::remove(errors, ignored);
  return result;
}

std::filesystem::path own_program() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

}  // namespace photorque
