// Whole files in and out, and the file that holds this code.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace photorque {

// Throws InputError unless there is a regular file: devices have no end, pipes can be read but
// once.
void require_plain_file(const std::filesystem::path& path);

// The bytes of a regular file. InputError when it is something else, cannot be read or is larger
// than `largest_bytes`.
std::string read_file(const std::filesystem::path& path, uint64_t largest_bytes = 1ull << 30);

// The bytes of the file that `folder` has under a relative path; nothing when there is none.
// InputError when the path, or a symbolic link on it, leads out of the folder and may not: names in
// models come from third parties.
std::optional<std::string> read_file_beside(const std::filesystem::path& folder,
                                            const std::string& name, uint64_t largest_bytes,
                                            bool may_leave);

// A hidden name beside `path`, with its extension, for an incomplete file. It names process and
// machine, so that files of a killed process are distinguishable from those of a living one.
std::filesystem::path temporary_beside(const std::filesystem::path& path);

// Removes what one process of this machine left in `folder` under such names, or what all did that
// are no more. Never throws.
void remove_leftovers(const std::filesystem::path& folder, int process);
void remove_leftovers_of_ended_processes(const std::filesystem::path& folder);

// Writes the names in a folder to the disk: new and renamed files there survive a power cut.
// InputError when that fails, but not where a file system cannot do it or the folder may not be
// read.
void sync_folder(const std::filesystem::path& folder);

// Makes a folder and those above it that are missing, with their names on the disk. InputError,
// with the key that asked for it, when that fails.
void make_folders(const std::filesystem::path& folder, const std::string& key = "");

// Calls `write` with the path of a temporary file in the same folder (same extension), which is
// made where it is missing, and then renames it to `path`: the file appears whole or not at all,
// after a power cut too, since it is on the disk before it has its name, and the name before this
// returns. If `write` throws, the temporary is removed. InputError when the folder cannot be
// written.
void write_file_whole(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

// Writes given bytes.
void write_file_whole(const std::filesystem::path& path, const std::string& bytes);

// The file that holds this code, from which its fonts and modules are found: the program
// ("/proc/self/exe" resolved), or the shared library that another program, such as Python, has
// loaded. Absolute where the loader was given an absolute path.
std::filesystem::path own_file();

}  // namespace photorque
