#include "images/writers/loading.h"

#include <dlfcn.h>

#include <filesystem>

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

// The module is beside the program or in its installation folder; nowhere else, also with other
// variables of the environment.
fs::path module_path() {
  const fs::path program = own_file().parent_path();
  for (const fs::path& place : {program, program / PHOTORQUE_MODULE_FOLDER}) {
    std::error_code unreadable;
    if (fs::is_regular_file(place / file_name, unreadable)) return place / file_name;
  }
  fail(program, "no " + std::string(file_name));
}

// Never unloaded: its exceptions may outlive any call.
const PictureFunctions& load() {
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
