// Models without optics: STL and OBJ.
#pragma once

#include "scenes/cad/model.h"
#include "tests/fuzz/target.h"

namespace photorque::fuzz {

inline void try_cad(CadFormat format, const uint8_t* data, size_t size) {
  may_refuse([&] {
    const std::string file = format == CadFormat::stl ? "fuzz.STL" : "fuzz.obj";
    if (cad_format(file) != format) std::abort();
    const std::vector<std::string> units = cad_units();
    const CadConventions conventions{metres_of_unit(units[size % units.size()]), size % 2 == 0};
    GltfOptions options;
    options.largest_bytes = 1 << 26;
    read_cad_bytes(text_of(data, size), file, format, conventions, options);
  });
}

}  // namespace photorque::fuzz
