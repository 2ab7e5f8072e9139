// Of models without optics: STL and OBJ.
#pragma once

#include "scenes/cad/model.h"
#include "tests/fuzz/target.h"

namespace photorque::fuzz {

inline void try_cad(CadFormat format, const uint8_t* data, size_t size) {
  may_refuse([&] {
    GltfOptions options;
    options.largest_bytes = 1 << 26;
    read_cad_bytes(text_of(data, size), "fuzz", format, {1e-3, true}, options);
  });
}

}  // namespace photorque::fuzz
