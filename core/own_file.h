// The place of this code, from which its fonts and modules are found.
#pragma once

#include <filesystem>

namespace photorque {

// The file that holds this code: the program ("/proc/self/exe" resolved), or the shared library
// that another program, such as Python, has loaded. Absolute where the loader was given an absolute
// path.
std::filesystem::path own_file();

}  // namespace photorque
