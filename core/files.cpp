#include "core/files.h"

#include <unistd.h>

#include <fstream>
#include <sstream>

#include "core/errors.h"

namespace photorque {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path, uint64_t largest_bytes) {
  std::error_code failure;
  if (!fs::exists(path, failure)) throw InputError({path.string()}, "", "no such file", "a file");
  if (fs::is_directory(path, failure)) throw InputError({path.string()}, "", "a folder", "a file");
  if (fs::is_character_file(path, failure) || fs::is_block_file(path, failure)) {
    throw InputError({path.string()}, "", "a device", "a file");
  }
  const uint64_t size = fs::file_size(path, failure);
  if (!failure && size > largest_bytes) {
    throw InputError({path.string()}, "", std::to_string(size) + " bytes",
                     "at most " + std::to_string(largest_bytes));
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError({path.string()}, "", "a file that cannot be read", "a readable file");
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return std::move(bytes).str();
}

void write_file_whole(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  fs::path temporary = path;
  temporary.replace_filename("." + path.stem().string() + "." + std::to_string(::getpid()) +
                             ".part" + path.extension().string());
  std::error_code failure;
  if (!path.parent_path().empty()) fs::create_directories(path.parent_path(), failure);
  if (failure) {
    throw InputError({path.parent_path().string()}, "", failure.message(), "a writable folder");
  }
  try {
    write(temporary);
    // Libraries that write pictures do not all say when the disk is full.
    if (fs::file_size(temporary, failure) == 0 && !failure) {
      throw InputError({path.string()}, "", "a write that failed", "space and permission");
    }
  } catch (...) {
    fs::remove(temporary, failure);
    throw;
  }
  fs::rename(temporary, path, failure);
  if (failure) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw InputError({path.string()}, "", failure.message(), "a path that can be written");
  }
}

void write_file_whole(const fs::path& path, const std::string& bytes) {
  write_file_whole(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw InputError({path.string()}, "", "a write that failed", "space and permission");
  });
}

}  // namespace photorque
