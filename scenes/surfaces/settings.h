// Optical properties as stated in an experiment's [[material]] or in the extras of a glTF material.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/typed_keys.h"
#include "raytrace/surfaces/measured_brdf.h"

namespace photorque {

// The optics of both sides of a sheet.
struct SheetOptics {
  OpticalSurface front;
  std::optional<OpticalSurface> back;  // empty: equal to the front
  std::vector<std::string> notices = {};
};

// Returns the bytes of a file that a table names, or nothing if there is none.
using SurfaceFiles = std::function<std::optional<std::string>(const std::string& name)>;

// Reads `absorptance`, `specular`, `diffuse`, `transmittance` and `retroreflectance` from a table:
// each a fraction in [0, 1], one number for all bands or an array with one per band (`bands` of
// them, at most max_bands). They sum to 1 in every band, the last being 0 when left out:
//   all of the first four given   the sum is checked to 1e-9;
//   one left out                  it is the remainder;
//   more left out                 they are zero, if the others sum to 1; else an error.
// The fractions returned sum to 1 to rounding. Further keys state the lobe of the specular fraction
// (raytrace/surfaces/mirrors.h) or glass in front (glass.h), behind which the fractions count.
// Beneath glass either diffuse, specular or transmittance is positive, roughness goes with diffuse
// alone, and slope_error_mrad and retroreflectance with none. sheet_keys() lists all keys.
// Other keys are left to the caller. Throws InputError with the table's file, line and key.
OpticalSurface read_surface(const Settings& table, int bands, std::string name);

// Like read_surface(), with an optional sub-table `back` for the side from which the corners of a
// triangle run clockwise, and with heat radiation of both sides. `reemitted` (default 0) is the
// fraction of the absorbed power that leaves at once. It is divided between the sides in proportion
// to `emissivity_front` and `emissivity_back` (default 1). Instead of fractions a side may have
// `brdf_file`, a table of measured scattering (read_brdf()) from `files`. Throws InputError if the
// file is missing or invalid, or if the surface would reflect more than it receives.
SheetOptics read_sheet(const Settings& table, int bands, const std::string& name,
                       const SurfaceFiles& files = {});

// Keys of read_sheet().
std::vector<Key> sheet_keys();

// Reads a table of measured scattering:
//
//   # any comments
//   incidence_deg,scatter_deg,azimuth_deg,brdf_1_sr
//   10,0,0,0.21
//   …
//
// Columns and rows may be in any order; commas separate the columns. Angles are those of BrdfTable,
// in degrees. Every incidence must occur with every scatter angle and every azimuth exactly once.
// With a single azimuth, scattering does not depend on it. Messages call the file `name`. Throws
// InputError with the line for a header that lacks a column, invalid or out-of-range numbers, and
// missing or repeated rows; also for more than a million rows.
BrdfTable read_brdf(const std::string& text, const std::string& name);

// A notice if a table ends below 45 deg, with its last angle: its last values are extended over the
// rest of the hemisphere. Empty otherwise, and for a constant BRDF.
std::optional<std::string> coverage_notice(const BrdfTable& table);

}  // namespace photorque
