// Ray files: a file that was read gives a lamp and can be written.
#pragma once

#include "sources/lamps/ray_file.h"
#include "sources/photometry/ray_set.h"
#include "tests/fuzz/target.h"

namespace photorque::fuzz {

template <typename Reader>
void try_rays(const Reader& reader, const uint8_t* data, size_t size) {
  may_refuse([&] {
    const RaySet set = reader(text_of(data, size), "fuzz");
    const RayLamp lamp(1.0, set);
    const double intensity = lamp.relative_intensity(0.1);
    if (!(intensity >= 0.0 && intensity <= 1.0)) std::abort();
    if (read_tm25(write_tm25(set), "written").rays.size() != set.rays.size()) std::abort();
  });
}

}  // namespace photorque::fuzz
