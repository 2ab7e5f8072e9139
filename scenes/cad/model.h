// Models from CAD programs that know neither unit nor optics, STL and OBJ, as scenes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scenes/gltf/reader.h"

namespace photorque {

enum class CadFormat { stl, obj };

// By the ending of the name, in any case.
std::optional<CadFormat> cad_format(const std::filesystem::path& path);

// Conventions that such a file does not state.
struct CadConventions {
  double metres_per_unit = 0.0;  // > 0
  bool y_is_up = false;          // (x, y, z) is body (x, −z, y), as in glTF; else the body's own
};

// Units that `[scene] unit` takes, in metres; 0 for any other word.
double metres_of_unit(const std::string& unit);
std::vector<std::string> cad_units();

// Each part (part.h) is a node of its name. Its material is called as in the file; where the file
// names none, as the file without folder and ending. Materials that the experiment does not
// describe absorb half of the light and scatter the other half, with a notice. Throws
// InputError as read_stl(), read_obj() and read_gltf() do.
GltfModel read_cad(const std::filesystem::path& path, const CadConventions& conventions,
                   const GltfOptions& options = {});

// Reads given bytes; `file` is how messages call them.
GltfModel read_cad_bytes(const std::string& bytes, const std::string& file, CadFormat format,
                         const CadConventions& conventions, const GltfOptions& options = {});

}  // namespace photorque
