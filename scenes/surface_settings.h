// Optical properties as the user writes them, in an experiment's [[material]] or in the extras of a
// glTF material.
#pragma once

#include <optional>
#include <string>

#include "core/settings.h"
#include "raytrace/surface.h"

namespace photorque {

// The optics of both sides of a sheet.
struct SheetOptics {
  OpticalSurface front;
  std::optional<OpticalSurface> back;  // nothing: like the front
};

// Reads `absorptance`, `specular`, `diffuse` and `transmittance` from a table: each a fraction in
// [0, 1], one number for all bands or an array with one per band (`bands` of them, at most
// max_bands). They sum to 1 in every band:
//   all four given       their sum is checked to 1e-9;
//   one left out         it is what remains;
//   more left out        they are zero, if the others sum to 1; else an error.
// The fractions returned sum to 1 to rounding. Other keys are left to the caller.
// Throws InputError with the table's file, line and key.
OpticalSurface read_surface(const Settings& table, int bands, std::string name);

// The same with an optional sub-table `back` for the side from which the corners of a triangle run
// clockwise.
SheetOptics read_sheet(const Settings& table, int bands, const std::string& name);

}  // namespace photorque
