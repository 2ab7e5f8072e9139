// The wrench on a body as a function of two angles, tabulated: how traced light reaches a
// simulation of attitude without tracing.
#pragma once

#include <cstddef>
#include <vector>

#include "core/wrench.h"

namespace photorque {

// Where a table is looked up.
struct TableAngles {
  double polar_rad = 0.0;   // tilt or elevation
  double around_rad = 0.0;  // heading or azimuth
};

// Body-frame wrenches on the grid `around_rad` × `polar_rad`, around outermost.
struct WrenchTable {
  enum class Angles {
    // Of a platform under fixed light: polar is the tilt from the vertical in [0, π], around the
    // heading of the tilt, as in lab_from_body_at().
    tilt_heading,
    // Of the direction towards a far light, in body axes: polar is the elevation in [−π/2, π/2]
    // above the xy plane, around the azimuth from x towards y.
    azimuth_elevation,
  };

  Angles angles = Angles::tilt_heading;
  std::vector<double> polar_rad;   // strictly ascending, at least one
  std::vector<double> around_rad;  // strictly ascending, at least one, spanning at most 2π
  Vec3 about_body_m = Vec3::Zero();
  std::vector<Vec3> force_body_N;
  std::vector<Vec3> torque_body_N_m;
  std::vector<Vec3> force_error_N;     // one standard error per component; zero where exact
  std::vector<Vec3> torque_error_N_m;  // likewise

  size_t nodes() const { return polar_rad.size() * around_rad.size(); }
  size_t node(size_t around, size_t polar) const { return around * polar_rad.size() + polar; }
};

// A table of zeros on the given grid. InputError when an axis is empty, not ascending or out of the
// range named above.
WrenchTable make_wrench_table(WrenchTable::Angles angles, std::vector<double> polar_rad,
                              std::vector<double> around_rad,
                              const Vec3& about_body_m = Vec3::Zero());

// Puts a body-frame wrench at a node, moved to the table's point.
void set_node(WrenchTable& table, size_t node, const WrenchEstimate& wrench);

// The wrench between the nodes, bilinear in the two angles. The second angle wraps when the table
// goes all round (its last node is no further from its first than its widest step); at a pole it
// does not matter. NumericalError outside the grid (by more than 1e-9 rad): a table says nothing
// about what was not traced.
Wrench wrench_at(const WrenchTable& table, const TableAngles& angles);

// Tilt and heading of an attitude, as the light of a lab source that is the same all round the
// vertical depends on them: from the lab's up in body axes, so that turning about the vertical
// changes neither.
TableAngles tilt_and_heading(const Quat& lab_from_body);
// Azimuth and elevation of a direction in body axes (any length but zero), and back (unit length).
TableAngles azimuth_and_elevation(const Vec3& towards_light_body);
Vec3 towards_light(const TableAngles& azimuth_elevation);

// At a pole (tilt 0 or 180 deg, elevation ±90 deg) every azimuth is the same attitude, and azimuths
// 360 deg apart always are. Largest difference of force between such nodes over the largest force
// of the table; 0 when the table is single-valued.
double multiplicity_spread(const WrenchTable& table);
// The table with all such nodes replaced by their mean.
WrenchTable single_valued(const WrenchTable& table);

// All forces and torques times `factor`: from a table per unit pressure to one at a given pressure.
WrenchTable scaled(const WrenchTable& table, double factor);

// For azimuth and elevation: the mean over the sphere of the force along the light's travel [N].
// Positive for every passive body; a negative one betrays a table of the opposite sign convention.
double mean_push_N(const WrenchTable& table);

}  // namespace photorque
