// Tables of measured scattering as text.
//
//   # any comments
//   incidence_deg,scatter_deg,azimuth_deg,brdf_1_sr
//   10,0,0,0.21
//   …
//
// Columns and rows have any order; commas separate the columns. Angles are those of BrdfTable, in
// degrees. Every incidence has every scatter angle and every azimuth once. With a single azimuth,
// scattering does not depend on it.
#pragma once

#include <optional>
#include <string>

#include "raytrace/surfaces/measured_brdf.h"

namespace photorque {

// `name` is how messages call the file. Throws InputError with the line for a header that lacks a
// column, numbers that are none or out of range, and rows that are missing or there twice; for more
// than a million rows too.
BrdfTable read_brdf(const std::string& text, const std::string& name);

// A notice for the user if a table ends below 45 deg, with its last angle: its last values continue
// over the rest of the hemisphere. Empty otherwise, and for a constant.
std::optional<std::string> coverage_notice(const BrdfTable& table);

}  // namespace photorque
