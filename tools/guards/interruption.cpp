#include "tools/guards/interruption.h"

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <fstream>

#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr int stop_waiting = SIGUSR2;  // from the destructor

// Processes that this one started, whichever of its threads did.
std::vector<pid_t> children() {
  std::vector<pid_t> all;
  std::error_code ignored;
  for (const fs::directory_entry& task : fs::directory_iterator("/proc/self/task", ignored)) {
    std::ifstream list(task.path() / "children");
    for (pid_t child = 0; list >> child;) all.push_back(child);
  }
  return all;
}

}  // namespace

Interruption::Interruption() {
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) {
      sigaddset(&signals_, signal);
    }
  }
  sigaddset(&signals_, stop_waiting);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  waiting_ = std::thread([this] { wait(); });
}

Interruption::~Interruption() {
  pthread_kill(waiting_.native_handle(), stop_waiting);
  waiting_.join();
}

Interruption::Watch::Watch(Interruption& interruption, const fs::path& folder)
    : interruption_(interruption) {
  InUse used{fs::absolute(folder)};
  std::error_code failure;
  for (fs::path p = used.folder; !fs::exists(p, failure) && p.has_relative_path();
       p = p.parent_path()) {
    ++used.missing;
  }
  const std::scoped_lock lock(interruption_.mutex_);
  interruption_.in_use_.push_back(std::move(used));
}

Interruption::Watch::~Watch() {
  const std::scoped_lock lock(interruption_.mutex_);
  interruption_.in_use_.pop_back();
}

void Interruption::wait() {
  int signal = 0;
  while (sigwait(&signals_, &signal) != 0) {
  }
  if (signal != stop_waiting) end(signal);
}

void Interruption::clean(pid_t process) const {
  for (size_t i = in_use_.size(); i-- > 0;) {
    remove_leftovers(in_use_[i].folder, process);
    fs::path p = in_use_[i].folder;
    for (size_t k = 0; k < in_use_[i].missing && ::rmdir(p.c_str()) == 0; ++k) p = p.parent_path();
  }
}

// The other threads still work, and one may make a temporary file after all are removed. So a
// child, which has none of these threads, waits until this process is gone and looks again; not
// even that is left to chance where the child is killed with it (the first process of a container).
void Interruption::end(int signal) {
  const std::scoped_lock lock(mutex_);
  const pid_t parent = ::getpid();
  clean(parent);
  int pipe_ends[2] = {-1, -1};
  const bool can_wait = ::pipe2(pipe_ends, O_CLOEXEC) == 0;
  for (const pid_t child : children()) ::kill(child, SIGTERM);
  if (can_wait && ::fork() == 0) {
    for (const int shared : {0, 1, 2, pipe_ends[1]}) ::close(shared);
    char none = 0;
    while (::read(pipe_ends[0], &none, 1) > 0) {
    }
    clean(parent);
    ::_exit(0);
  }
  ::signal(signal, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  ::kill(parent, signal);
  for (;;) ::pause();
}

}  // namespace photorque
