// What fuzz targets share. A target is one reader of files from outside: any bytes must give what
// it reads or an InputError, nothing else.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

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

// For readers that take a path: the bytes in a file that no disk sees.
class FileInMemory {
 public:
  FileInMemory(const uint8_t* data, size_t size) : file_(memfd_create("fuzz", 0)) {
    if (file_ < 0 || write(file_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~FileInMemory() { close(file_); }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

}  // namespace photorque::fuzz
