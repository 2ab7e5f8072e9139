#include "core/own_file.h"

#include <dlfcn.h>

namespace photorque {

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
