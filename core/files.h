// Reading and writing of whole files, and the path of the file that contains this code.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace photorque {

// Throws InputError unless the path is a regular file: devices have no end, and pipes can be read
// only once.
void require_plain_file(const std::filesystem::path& path);

// The content of a regular file. Throws InputError if the path is something else, cannot be read or
// is larger than `largest_bytes`.
std::string read_file(const std::filesystem::path& path, uint64_t largest_bytes = 1ull << 30);

// The content of the file with a relative path in `folder`; nothing if there is none. Throws
// InputError if the path, or a symbolic link on it, leads out of the folder and `may_leave` is
// false: names in models come from third parties.
std::optional<std::string> read_file_beside(const std::filesystem::path& folder,
                                            const std::string& name, uint64_t largest_bytes,
                                            bool may_leave);

// A hidden name beside `path`, with its extension, for an incomplete file. It contains the number
// of the process and the machine, so that files of ended processes can be recognised.
std::filesystem::path temporary_beside(const std::filesystem::path& path);

// Removes the temporary files that one process of this machine, or all processes that have ended,
// left in `folder`. Never throws.
void remove_leftovers(const std::filesystem::path& folder, int process);
void remove_leftovers_of_ended_processes(const std::filesystem::path& folder);

// Syncs the names in a folder to the disk: new and renamed files there survive a power cut. Throws
// InputError if that fails, but not if the file system does not support it or the folder is not
// readable.
void sync_folder(const std::filesystem::path& folder);

// Creates a folder and its missing parents, and syncs their names. Throws InputError with the key
// that requested the folder if that fails.
void make_folders(const std::filesystem::path& folder, const std::string& key = "");

// Calls `write` with the path of a temporary file in the folder of `path` (with the same
// extension), and then renames this file to `path`. Missing folders are created. The file appears
// completely or not at all, also after a power cut: it is synced before the renaming, and its name
// before this returns. If `write` throws, the temporary file is removed. Throws InputError if the
// folder is not writable.
void write_file_whole(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

// Writes the bytes as by the function above.
void write_file_whole(const std::filesystem::path& path, const std::string& bytes);

// The file that contains this code, from which its fonts and modules are found: the program
// ("/proc/self/exe" resolved), or the shared library that another program, such as Python, has
// loaded. The path is absolute if the loader received an absolute path.
std::filesystem::path own_file();

}  // namespace photorque
