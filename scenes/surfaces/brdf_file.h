// Tables of measured scattering as text.
//
//   # any comments
//   incidence_deg,scatter_deg,azimuth_deg,brdf_1_sr
//   10,0,0,0.21
//   …
//
// The columns stand in any order, separated by commas; so do the rows. Angles are those of
// BrdfTable, in degrees. Every incidence comes with every scatter and every azimuth, once; one
// azimuth alone means that scattering does not depend on it.
#pragma once

#include <string>

#include "raytrace/surfaces/brdf_table.h"

namespace photorque {

// `name` is how messages call the file. Throws InputError with the line for a header that lacks a
// column, numbers that are none or out of range, and rows that are missing or there twice; for more
// than a million rows too.
BrdfTable read_brdf(const std::string& text, const std::string& name);

}  // namespace photorque
