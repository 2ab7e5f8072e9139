// Tables of measured scattering as text.
//
//   # any comments
//   incidence_deg,scatter_deg,azimuth_deg,brdf_1_sr
//   10,0,0,0.21
//   …
//
// Columns and rows may be in any order; commas separate the columns. Angles are those of BrdfTable,
// in degrees. Every incidence must occur with every scatter angle and every azimuth exactly once.
// With a single azimuth, scattering does not depend on it.
#pragma once

#include <optional>
#include <string>

#include "raytrace/surfaces/measured_brdf.h"

namespace photorque {

// Messages call the file `name`. Throws InputError with the line for a header that lacks a column,
// invalid or out-of-range numbers, and missing or repeated rows; also for more than a million rows.
BrdfTable read_brdf(const std::string& text, const std::string& name);

// A notice if a table ends below 45 deg, with its last angle: its last values are extended over the
// rest of the hemisphere. Empty otherwise, and for a constant BRDF.
std::optional<std::string> coverage_notice(const BrdfTable& table);

}  // namespace photorque
