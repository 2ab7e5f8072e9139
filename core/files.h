// Whole files in and out.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace photorque {

// The bytes of a file. InputError when it is a device, cannot be read or is larger than
// `largest_bytes`.
std::string read_file(const std::filesystem::path& path, uint64_t largest_bytes = 1ull << 30);

// Calls `write` with the path of a temporary file in the same folder (same extension) and then
// renames it to `path`: the file appears whole or not at all. If `write` throws, the temporary is
// removed. InputError when the folder cannot be written.
void write_file_whole(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

// The same for bytes at hand.
void write_file_whole(const std::filesystem::path& path, const std::string& bytes);

}  // namespace photorque
