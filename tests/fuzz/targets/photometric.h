// Lamp tables: a table that was read can be interpolated and written.
#pragma once

#include "sources/photometry/file.h"
#include "sources/profiles/tabulated_intensity.h"
#include "tests/fuzz/target.h"
#include "tests/sources/ies_writer.h"

namespace photorque::fuzz {

template <typename Reader>
void try_photometric(const Reader& reader, const uint8_t* data, size_t size) {
  may_refuse([&] {
    const PhotometricFile file = reader(text_of(data, size), "fuzz");
    constexpr size_t slow = 20000;  // larger tables take their time, which is no fault
    if (file.table.intensity.size() > slow) return;
    const TabulatedIntensity intensity(file.table);
    if (!(intensity.at(0.3, 0.2) >= 0.0)) std::abort();
    if (read_ies(write_ies(file), "written").table.intensity != file.table.intensity) std::abort();
  });
}

}  // namespace photorque::fuzz
