// What fuzz targets share. A target is one reader of files from outside: any bytes must give what
// it reads or an InputError, nothing else.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/errors.h"

namespace photorque::fuzz {

inline std::string text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// The one exception that is allowed.
template <typename Read>
void may_refuse(const Read& read) {
  try {
    read();
  } catch (const InputError&) {
  }
}

// For readers that take a path: the bytes in a file that no disk sees. One at a time of each
// `place` (0 or 1), which is opened once and written again: a new file costs more than most readers
// take.
class FileInMemory {
 public:
  FileInMemory(const uint8_t* data, size_t size, size_t place = 0) : file_(file_of(place)) {
    if (ftruncate(file_, 0) != 0 || pwrite(file_, data, size, 0) != static_cast<ssize_t>(size)) {
      std::abort();
    }
  }
  explicit FileInMemory(const std::string& text, size_t place = 1)
      : FileInMemory(reinterpret_cast<const uint8_t*>(text.data()), text.size(), place) {}
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  static int file_of(size_t place) {
    static const std::array<int, 2> files = {memfd_create("fuzz", 0), memfd_create("again", 0)};
    return files.at(place);
  }

  int file_;
};

// A folder of this process in memory, for what is written under a name.
inline const std::filesystem::path& folder_in_memory() {
  static const std::filesystem::path folder = [] {
    std::string name = "/dev/shm/photorque_fuzz_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) std::abort();
    return std::filesystem::path(name);
  }();
  return folder;
}

}  // namespace photorque::fuzz
