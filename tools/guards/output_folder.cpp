#include "tools/guards/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

InputError refused(const fs::path& path, const std::string& found, const std::string& expected) {
  return {{path.string()}, "--out", found, expected};
}

// What cleans up after a run that was stopped (interruption.h) holds its lock for some milliseconds
// more.
bool take_lock(int descriptor, int how, bool patiently) {
  constexpr int tries = 50, apart_us = 20'000;
  if (patiently) return ::flock(descriptor, how) == 0;
  for (int i = 0; ::flock(descriptor, how | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK || i == tries) return false;
    ::usleep(apart_us);
  }
  return true;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& path, Others others) : path_(fs::absolute(path)) {
  try {
    // Whoever had the lock may have removed the folder meanwhile: then it is made again.
    do make();
    while (!lock(others));
    remove_leftovers_of_the_dead(path_);
    try_to_write();
  } catch (...) {
    remove_empty();
    if (descriptor_ >= 0) ::close(descriptor_);
    throw;
  }
}

OutputFolder::~OutputFolder() {
  remove_empty();  // before the lock goes
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

// A page of bytes, as a full disk takes the name of a file but nothing in it.
void OutputFolder::try_to_write() const {
  const fs::path trial = temporary_beside(path_ / "trial");
  const int file = ::open(trial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  int error = file < 0 ? errno : 0;
  constexpr std::array<char, 4096> page{};
  if (file >= 0) {
    if (::write(file, page.data(), page.size()) != static_cast<ssize_t>(page.size())) {
      error = errno == 0 ? ENOSPC : errno;
    }
    if (::close(file) != 0 && error == 0) error = errno;
    ::unlink(trial.c_str());
  }
  if (error != 0) {
    throw refused(path_, std::string("a folder that takes no files (") + std::strerror(error) + ")",
                  "space and permission");
  }
}

// False when the folder that was locked is not the one of this name any more.
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

}  // namespace photorque
