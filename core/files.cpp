#include "core/files.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "core/errors.h"

namespace photorque {

namespace fs = std::filesystem;

namespace {

// "@machine.part": process numbers are unique on one machine only.
std::string host_mark() {
  char host[64] = {};
  if (::gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
  std::string mark = "@";
  for (const char* c = host; *c != '\0'; ++c) {
    mark += std::isalnum(static_cast<unsigned char>(*c)) != 0 ? *c : '-';
  }
  return mark + ".part";
}

// A random name, so that a third party cannot place a link there in advance.
std::string unpredictable() {
  uint64_t bits = 0;
  if (::getrandom(&bits, sizeof bits, 0) != static_cast<ssize_t>(sizeof bits)) {
    throw NumericalError("the system returned no random bytes for the names of temporary files");
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(bits));
  return text;
}

// The process of this machine in the name of a temporary file; nothing for other names.
std::optional<pid_t> writer_of(const std::string& name) {
  const size_t mark = name.rfind(host_mark());
  if (!name.starts_with('.') || mark == std::string::npos) return std::nullopt;
  const size_t dot = name.rfind('.', mark);
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data() + dot + 1, name.data() + mark, process);
  if (error != std::errc() || end != name.data() + mark || process <= 0) return std::nullopt;
  return process;
}

void remove_where(const fs::path& folder, const std::function<bool(pid_t)>& unwanted) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::optional<pid_t> writer = writer_of(entry.path().filename().string());
    if (writer && unwanted(*writer)) fs::remove_all(entry.path(), ignored);
  }
}

// Syncs an opened file to the disk and closes it. Returns false if the sync failed, but true if the
// file system does not support it.
bool sync_and_close(int opened) {
  const bool synced = ::fsync(opened) == 0 || errno == EINVAL || errno == EROFS;
  ::close(opened);
  return synced;
}

// Syncs a file to the disk. This must precede the renaming of the file: otherwise a power cut could
// leave the name without the content.
bool reaches_disk(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  return file >= 0 && sync_and_close(file);
}

// Whether the path lies in a temporary folder. The code that moves results out of such a folder
// syncs their names.
bool is_temporary(const fs::path& folder) {
  return std::any_of(folder.begin(), folder.end(),
                     [](const fs::path& part) { return writer_of(part.string()).has_value(); });
}

// A failed write, with the name that the file would have got: without temporary folders.
InputError write_failed(const fs::path& path, const std::string& found = "a write that failed",
                        const std::string& expected = "space and permission") {
  fs::path wanted;
  for (const fs::path& part : path) {
    if (!writer_of(part.string())) wanted /= part;
  }
  return {{wanted.string()}, "", found, expected};
}

// Creates a new file; fails at a link or an existing file.
void make_own_file(const fs::path& path, const fs::path& wanted) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) throw write_failed(wanted, std::strerror(errno), "a path that can be written");
  ::close(file);
}

}  // namespace

void require_plain_file(const fs::path& path) {
  std::error_code failure;
  const fs::file_status status = fs::status(path, failure);
  const auto kind = [&] {
    switch (status.type()) {
      case fs::file_type::directory:
        return "a folder";
      case fs::file_type::character:
      case fs::file_type::block:
        return "a device";
      case fs::file_type::fifo:
      case fs::file_type::socket:
        return "a pipe, which can be read only once";
      case fs::file_type::not_found:
        return "no such file";
      default:
        return "a file of a type that is not supported";
    }
  };
  if (status.type() == fs::file_type::regular) return;
  throw InputError({path.string()}, "", kind(), "a file");
}

std::string read_file(const fs::path& path, uint64_t largest_bytes) {
  require_plain_file(path);
  std::error_code failure;
  const uint64_t size = fs::file_size(path, failure);
  if (!failure && size > largest_bytes) {
    throw InputError({path.string()}, "", std::to_string(size) + " bytes",
                     "at most " + std::to_string(largest_bytes));
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError({path.string()}, "", "a file that cannot be read", "a readable file");
  std::string bytes(failure ? 0 : size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(in.gcount()));
  if (in.bad()) throw InputError({path.string()}, "", "a read that failed", "a readable file");
  // Reads on for files that grew meanwhile, and for files of the kernel, whose reported size is 0.
  constexpr size_t piece = 1 << 16;
  while (in && bytes.size() <= largest_bytes) {
    const size_t had = bytes.size();
    bytes.resize(had + piece);
    in.read(bytes.data() + had, piece);
    bytes.resize(had + static_cast<size_t>(in.gcount()));
  }
  if (bytes.size() > largest_bytes) {
    throw InputError({path.string()}, "", "more than " + std::to_string(largest_bytes) + " bytes",
                     "at most these");
  }
  return bytes;
}

std::optional<std::string> read_file_beside(const fs::path& folder, const std::string& name,
                                            uint64_t largest_bytes, bool may_leave) {
  const fs::path path = folder / name;
  std::error_code failure;
  if (!fs::is_regular_file(path, failure)) return std::nullopt;
  if (!may_leave) {
    const fs::path inside = fs::weakly_canonical(folder.empty() ? "." : folder, failure);
    const fs::path real = fs::weakly_canonical(path, failure);
    const auto differs = std::mismatch(inside.begin(), inside.end(), real.begin(), real.end());
    if (failure || differs.first != inside.end()) {
      throw InputError({path.string()}, "", "a link or path out of its folder",
                       "a file inside it (or --allow-outside)");
    }
  }
  return read_file(path, largest_bytes);
}

fs::path temporary_beside(const fs::path& path) {
  fs::path temporary = path;
  temporary.replace_filename("." + path.stem().string() + "." + unpredictable() + "." +
                             std::to_string(::getpid()) + host_mark() + path.extension().string());
  return temporary;
}

void remove_leftovers(const fs::path& folder, int process) {
  remove_where(folder, [&](pid_t writer) { return writer == process; });
}

void remove_leftovers_of_ended_processes(const fs::path& folder) {
  remove_where(folder, [](pid_t writer) { return ::kill(writer, 0) != 0 && errno == ESRCH; });
}

void sync_folder(const fs::path& folder) {
  const int opened = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  if (!sync_and_close(opened)) {
    throw write_failed(folder);
  }
}

void make_folders(const fs::path& folder, const std::string& key) {
  std::error_code failure;
  std::vector<fs::path> above;  // parents of the new folders
  for (fs::path place = fs::absolute(folder, failure);
       !fs::exists(place, failure) && place.has_relative_path(); place = place.parent_path()) {
    above.push_back(place.parent_path());
  }
  fs::create_directories(folder, failure);
  if (failure) {
    const bool through_file = failure == std::errc::not_a_directory;
    throw InputError({folder.string()}, key,
                     through_file ? "a path through a file" : failure.message(),
                     "a folder that can be made");
  }
  for (const fs::path& place : above) sync_folder(place);
}

void write_file_whole(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path temporary = temporary_beside(path);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  make_folders(folder);
  std::error_code failure;
  try {
    make_own_file(temporary, path);
    write(temporary);
    if (!reaches_disk(temporary)) {
      throw write_failed(path);
    }
  } catch (...) {
    fs::remove(temporary, failure);
    throw;
  }
  fs::rename(temporary, path, failure);
  if (failure) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw write_failed(path, failure.message(), "a path that can be written");
  }
  if (!is_temporary(folder)) sync_folder(folder);
}

void write_file_whole(const fs::path& path, const std::string& bytes) {
  write_file_whole(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw write_failed(path);
  });
}

std::filesystem::path own_file() {
  Dl_info info = {};
  if (dladdr(reinterpret_cast<const void*>(&own_file), &info) != 0) {
    const std::filesystem::path holder = info.dli_fname;
    if (holder.filename().string().find(".so") != std::string::npos) return holder;
  }
  // The loader identifies a program by the word with which it was started.
  return std::filesystem::read_symlink("/proc/self/exe");
}

}  // namespace photorque
