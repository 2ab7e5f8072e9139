// STL and OBJ models from CAD programs, which state neither unit nor optics, as scenes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scenes/gltf/reader.h"

namespace photorque {

enum class CadFormat { stl, obj };

// Format from the ending of the file name, in upper or lower case; empty for other endings.
std::optional<CadFormat> cad_format(const std::filesystem::path& path);

// Conventions that such a file does not state.
struct CadConventions {
  double metres_per_unit = 0.0;  // > 0
  // (x, y, z) is body (x, −z, y), as in glTF; if false, the axes are those of the body
  bool y_is_up = false;
};

// Length in metres of a unit accepted by `[scene] unit`; 0 for any other word.
double metres_of_unit(const std::string& unit);
std::vector<std::string> cad_units();

// Makes one node per part (part.h), with the part's name. Its material has the name in the file or,
// if there is none, the file name without folder and ending; for a solid of an STL file, the name
// of the solid if the experiment describes a material of this name. Materials that the experiment
// does not describe absorb half of the light and scatter the other half, with a notice. Throws
// InputError like read_stl(), read_obj() and read_gltf().
GltfModel read_cad(const std::filesystem::path& path, const CadConventions& conventions,
                   const GltfOptions& options = {});

// Reads given bytes; messages call them `file`.
GltfModel read_cad_bytes(const std::string& bytes, const std::string& file, CadFormat format,
                         const CadConventions& conventions, const GltfOptions& options = {});

}  // namespace photorque
