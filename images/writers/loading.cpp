#include "images/writers/loading.h"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/mman.h>

#include <filesystem>
#include <future>
#include <system_error>
#include <thread>
#include <vector>

#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr const char* file_name = "photorque_pictures.so";

[[noreturn]] void fail(const fs::path& place, const std::string& found) {
  throw InputError({place.string()}, "", found,
                   std::string(file_name) + " of this program, beside it or in " +
                       PHOTORQUE_MODULE_FOLDER + " from there");
}

// The module must be beside the program or in its installation folder; environment variables cannot
// change this.
fs::path module_path() {
  const fs::path program = own_file().parent_path();
  for (const fs::path& place : {program, program / PHOTORQUE_MODULE_FOLDER}) {
    std::error_code unreadable;
    if (fs::is_regular_file(place / file_name, unreadable)) return place / file_name;
  }
  fail(program, "no " + std::string(file_name));
}

// Whether the stack of one more thread can be allocated: the error of a thread that cannot start is
// the same without memory and with too many threads.
bool has_room_for_stack() {
  pthread_attr_t usual;
  size_t bytes = 0;
  if (::pthread_attr_init(&usual) != 0) return false;
  ::pthread_attr_getstacksize(&usual, &bytes);
  ::pthread_attr_destroy(&usual);
  void* const stack =
      ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (stack == MAP_FAILED) return false;
  ::munmap(stack, bytes);
  return true;
}

// The module's libraries start threads while they are loaded. If a thread cannot start, they abort
// or hang; therefore memory and threads are tested first.
void require_room_and_threads() {
  constexpr size_t room = size_t{512} << 20, threads = 16;  // they need 410 MB and 4 threads
  void* const place =
      ::mmap(nullptr, room, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (place == MAP_FAILED) {
    throw NumericalError("not enough memory for " + std::string(file_name) +
                         ": found less than 512 MB of address space (ulimit -v)");
  }
  ::munmap(place, room);
  std::promise<void> all_started;
  const std::shared_future<void> go_on = all_started.get_future();
  std::vector<std::thread> started;
  bool enough = true, has_memory = true;
  try {
    while (started.size() < threads) started.emplace_back([&] { go_on.wait(); });
  } catch (const std::system_error&) {
    enough = false;
    has_memory = has_room_for_stack();
  }
  all_started.set_value();
  for (std::thread& thread : started) thread.join();
  if (!has_memory) {
    throw NumericalError("not enough memory for " + std::string(file_name) +
                         ": found the stacks of " + std::to_string(started.size()) +
                         " threads, expected " + std::to_string(threads) +
                         " (ulimit -d, ulimit -v)");
  }
  if (!enough) {
    throw NumericalError("not enough threads for " + std::string(file_name) + ": found " +
                         std::to_string(started.size()) + ", expected " + std::to_string(threads) +
                         " (ulimit -u)");
  }
}

// The module is never unloaded, because its exceptions may outlive a call.
const PictureFunctions& load() {
  require_room_and_threads();
  const fs::path path = module_path();
  void* const module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    const std::string why = dlerror();
    for (const char* sign : {"failed to map", "annot allocate memory", "annot create"}) {
      if (why.find(sign) == std::string::npos) continue;
      throw NumericalError("not enough memory for " + std::string(file_name) + " (" + why + ")");
    }
    fail(path, why);
  }
  const auto entry = reinterpret_cast<PictureEntry*>(dlsym(module, picture_entry));
  if (entry == nullptr) fail(path, "another library");
  const PictureFunctions& functions = *entry();
  if (functions.build != picture_build()) fail(path, "the module of build " + functions.build);
  return functions;
}

const PictureFunctions& functions() {
  static const PictureFunctions& loaded = load();
  return loaded;
}

}  // namespace

void require_pictures() {
  require_room_and_threads();
  module_path();
}

void write_exr(const fs::path& path, int width, int height,
               const std::vector<ImageChannel>& channels, const ImageMetadata& metadata) {
  functions().exr(path, width, height, channels, metadata);
}

void write_tiff(const fs::path& path, int width, int height,
                const std::vector<ImageChannel>& channels, const ImageMetadata& metadata) {
  functions().tiff(path, width, height, channels, metadata);
}

void write_png(const fs::path& path, const Picture& picture, const ImageMetadata& metadata) {
  functions().png(path, picture, metadata);
}

LinearPicture read_picture(const std::string& bytes) {
  return functions().read(bytes);
}

}  // namespace photorque
