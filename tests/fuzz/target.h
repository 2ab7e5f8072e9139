// Shared by fuzz targets. A target is one reader of files from outside: any bytes must give what it
// reads or an InputError, nothing else.
#pragma once

#include <fcntl.h>
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

// A folder of this process in memory, for what is written under a name; in PHOTORQUE_FUZZ_FOLDER,
// if the caller removes it afterwards.
inline const std::filesystem::path& folder_in_memory() {
  static const std::filesystem::path folder = [] {
    const char* const wanted = std::getenv("PHOTORQUE_FUZZ_FOLDER");
    std::string name = std::string(wanted ? wanted : "/dev/shm") + "/photorque_fuzz_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) std::abort();
    return std::filesystem::path(name);
  }();
  return folder;
}

// For readers that take a path: the bytes in a file that no disk sees. One at a time of each
// `place` (0 or 1), which is opened once and written again: a new file costs more than most readers
// take.
class FileInMemory {
 public:
  FileInMemory(const uint8_t* data, size_t size, size_t place = 0) : place_(place) {
    const int file = files().at(place);
    if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) {
      std::abort();
    }
  }
  explicit FileInMemory(const std::string& text, size_t place = 1)
      : FileInMemory(reinterpret_cast<const uint8_t*>(text.data()), text.size(), place) {}
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;
  const std::filesystem::path& path() const { return paths().at(place_); }

 private:
  static const std::array<std::filesystem::path, 2>& paths() {
    static const std::array<std::filesystem::path, 2> both = {folder_in_memory() / "file",
                                                              folder_in_memory() / "again"};
    return both;
  }
  static const std::array<int, 2>& files() {
    const auto made = [](const std::filesystem::path& path) {
      return open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    };
    static const std::array<int, 2> both = {made(paths()[0]), made(paths()[1])};
    return both;
  }

  size_t place_;
};

}  // namespace photorque::fuzz
