#include "tools/runs/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

InputError refused(const fs::path& path, const std::string& found, const std::string& expected) {
  return {{path.string()}, "--out", found, expected};
}

// Takes the lock of the folder. The process that cleans up after a stopped run (Interruption) holds
// it for some milliseconds, therefore it is tried several times.
bool take_lock(int descriptor, int how, bool waits) {
  constexpr int tries = 50, apart_us = 20'000;
  if (waits) return ::flock(descriptor, how) == 0;
  for (int i = 0; ::flock(descriptor, how | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK || i == tries) return false;
    ::usleep(apart_us);
  }
  return true;
}

constexpr int stop_waiting = SIGUSR2;  // sent by the destructor

// Path of the folder without links and dots, so that folders created on it can be removed again.
fs::path place_of(const fs::path& folder) {
  std::error_code failure;
  const fs::path place = fs::weakly_canonical(fs::absolute(folder), failure);
  if (failure) return fs::absolute(folder);
  return place.has_filename() ? place : place.parent_path();  // without a trailing slash
}

// Folders in which every user may create folders.
bool is_of_all_users(const fs::path& place) {
  constexpr std::array<std::string_view, 11> shared = {"/",    "/dev/shm", "/home",   "/media",
                                                       "/mnt", "/opt",     "/srv",    "/run/user",
                                                       "/tmp", "/usr/src", "/var/tmp"};
  return std::ranges::find(shared, place.string()) != shared.end();
}

// Whether a folder is in one of the trees that the system and its packages manage.
// Source: Filesystem Hierarchy Standard 3.0, sections 3 to 6.
bool is_in_tree_of_the_system(const fs::path& place) {
  constexpr std::array<std::string_view, 10> trees = {"bin", "boot", "dev", "etc", "proc",
                                                      "run", "sbin", "sys", "usr", "var"};
  for (fs::path above = place; above.has_relative_path(); above = above.parent_path()) {
    if (above != place && is_of_all_users(above)) return false;
  }
  const std::string tree = place.has_relative_path() ? place.relative_path().begin()->string() : "";
  return std::ranges::find(trees, tree) != trees.end() || tree.starts_with("lib");
}

// The user to whom the folder belongs or, if it does not exist, the nearest one above it.
uid_t owner_of(fs::path place) {
  struct stat found {};
  while (::stat(place.c_str(), &found) != 0 && place.has_relative_path()) {
    place = place.parent_path();
  }
  return found.st_uid;
}

// A temporary file, for a trial; negative if it cannot be created.
int open_trial(const fs::path& trial) {
  return ::open(trial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
}

// Whether new files in a folder belong to the owner of the folder: some file systems assign all
// files to one user.
bool assigns_files_to(uid_t owner, const fs::path& folder) {
  const fs::path trial = temporary_beside(folder / "trial");
  const int file = open_trial(trial);
  if (file < 0) return false;
  struct stat made {};
  const bool is_theirs = ::fstat(file, &made) == 0 && made.st_uid == owner;
  ::close(file);
  ::unlink(trial.c_str());
  return is_theirs;
}

// Results are written neither into the trees of the system, except into folders that a user other
// than the superuser has there, nor into an existing folder of another user.
void require_own(const fs::path& place) {
  const uid_t user = ::geteuid(), owner = owner_of(place);
  if (is_of_all_users(place) || (is_in_tree_of_the_system(place) && (user == 0 || owner != user))) {
    throw refused(place, "a folder of the system", "a folder that belongs to you, or a new one");
  }
  std::error_code failure;
  if (fs::exists(place, failure) && owner != user && !assigns_files_to(owner, place)) {
    throw refused(place, "a folder of user " + std::to_string(owner),
                  "a folder that belongs to you, or a new one");
  }
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& path, Others others) : path_(place_of(path)) {
  require_own(path_);
  try {
    // The previous holder of the lock may have removed the folder meanwhile: then it is recreated.
    do make();
    while (!lock(others));
    remove_leftovers_of_ended_processes(path_);
    try_to_write();
  } catch (...) {
    remove_empty();
    if (descriptor_ >= 0) ::close(descriptor_);
    throw;
  }
}

OutputFolder::~OutputFolder() {
  remove_empty();  // before the lock is released
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFolder::make() {
  std::error_code failure;
  made_.clear();
  for (fs::path p = path_; !fs::exists(p, failure) && p.has_relative_path(); p = p.parent_path()) {
    made_ = p;
  }
  if (fs::exists(path_, failure) && !fs::is_directory(path_, failure)) {
    throw refused(path_, "a file", "a folder");
  }
  make_folders(path_, "--out");
}

// Writes a page of bytes: on a full disk a file can be created, but not filled.
void OutputFolder::try_to_write() const {
  const fs::path trial = temporary_beside(path_ / "trial");
  const int file = open_trial(trial);
  int error = file < 0 ? errno : 0;
  constexpr std::array<char, 4096> page{};
  if (file >= 0) {
    // After a part, only the next write has the reason why the rest was not written.
    for (size_t done = 0; error == 0 && done < page.size();) {
      const ssize_t written = ::write(file, page.data() + done, page.size() - done);
      if (written > 0) {
        done += static_cast<size_t>(written);
      } else {
        error = written < 0 ? errno : ENOSPC;
      }
    }
    if (::close(file) != 0 && error == 0) error = errno;
    ::unlink(trial.c_str());
  }
  if (error != 0) {
    throw refused(path_,
                  std::string("a folder that is not writable (") + std::strerror(error) + ")",
                  "space and permission");
  }
}

// Returns false if the locked folder is no longer the one of this name.
bool OutputFolder::lock(Others others) {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) {
    if (errno == ENOENT) return false;
    throw refused(path_, std::strerror(errno), "a folder that can be read");
  }
  const int how = others == Others::share ? LOCK_SH : LOCK_EX;
  if (!take_lock(descriptor_, how, others == Others::wait)) {
    if (errno == EWOULDBLOCK) {
      throw refused(path_, "a folder that another run is writing into",
                    "another folder, or the end of that run");
    }
    return true;
  }
  struct stat locked {
  }, named{};
  return ::fstat(descriptor_, &locked) == 0 && ::stat(path_.c_str(), &named) == 0 &&
         locked.st_ino == named.st_ino && locked.st_dev == named.st_dev;
}

void OutputFolder::remove_empty() const {
  if (made_.empty()) return;
  for (fs::path p = path_; ::rmdir(p.c_str()) == 0 && p != made_; p = p.parent_path()) {
  }
}

Interruption::Interruption() {
  sigemptyset(&signals_);
  // Batch systems announce their limits with SIGUSR1, SIGUSR2 and SIGXCPU.
  for (const int signal :
       {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGUSR1, SIGXCPU, stop_waiting}) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 &&
        (now.sa_handler != SIG_IGN || signal == stop_waiting)) {
      sigaddset(&signals_, signal);
    }
  }
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  waiting_ = std::thread([this] { wait(); });
}

Interruption::~Interruption() {
  is_over_ = true;
  pthread_kill(waiting_.native_handle(), stop_waiting);
  waiting_.join();
}

Interruption::Watch::Watch(Interruption& interruption, const fs::path& folder)
    : interruption_(interruption) {
  InUse used{place_of(folder)};
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
  if (signal != stop_waiting || !is_over_) end(signal);
}

void Interruption::clean(pid_t process) const {
  for (size_t i = in_use_.size(); i-- > 0;) {
    remove_leftovers(in_use_[i].folder, process);
    fs::path p = in_use_[i].folder;
    for (size_t k = 0; k < in_use_[i].missing && ::rmdir(p.c_str()) == 0; ++k) p = p.parent_path();
  }
}

// The other threads are still running, and may create a temporary file after all have been removed.
// Therefore a child process, which lacks these threads, waits until this process has ended and
// removes files again. The files are also removed here first, because the child may be killed
// together with this process (the first process of a container).
void Interruption::end(int signal) {
  const std::scoped_lock lock(mutex_);
  const pid_t parent = ::getpid();
  clean(parent);
  int pipe_ends[2] = {-1, -1};
  const bool can_wait = ::pipe2(pipe_ends, O_CLOEXEC) == 0;
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
