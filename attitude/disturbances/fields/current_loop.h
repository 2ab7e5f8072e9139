// Currents as magnets: their dipole and their field. Source: eq. 26–28, Biot and Savart.
#pragma once

#include <span>
#include <vector>

#include "core/settings/settings.h"
#include "core/transform.h"

namespace photorque {

// Vacuum permeability, CODATA 2018.
inline constexpr double vacuum_permeability_N_A2 = 1.25663706212e-6;

// Area vector of a closed polygon [m²]: its normal by the right hand along the corners. Independent
// of the origin; a polygon that is not plane has one too.
Vec3 polygon_area_m2(std::span<const Vec3> corners_m);

struct CurrentLoop {
  double current_A = 0.0;
  double turns = 1.0;
  Vec3 area_body_m2 = Vec3::Zero();  // of one turn, along its normal
};

// Eq. 28: m = Σ N I S [A m²].
Vec3 dipole_A_m2(std::span<const CurrentLoop> loops);

// Reads tables with current_A, turns (default 1) and either area_m2 (a vector) or corners_m (a
// polygon, at least three).
std::vector<CurrentLoop> read_current_loops(const std::vector<Settings>& loops);

// Field of a current that flows along a straight wire from `from_m` to `to_m` [T]; a closed path of
// such wires is physical, one alone is not. Singular on the wire.
Vec3 straight_wire_field_T(const Vec3& from_m, const Vec3& to_m, double current_A,
                           const Vec3& at_m);

// Field of a closed polygon [T].
Vec3 polygon_field_T(std::span<const Vec3> corners_m, double current_A, const Vec3& at_m);

}  // namespace photorque
