// Results and pictures of a table of wrenches over angles: discs of tilt and heading, hemispheres
// of directions.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"
#include "core/wrench.h"

namespace photorque {

// Smooth maps of the torque's components about body x, y and z and of its magnitude on `name`. The
// headings or azimuths of the table must cover the whole circle in equal steps; otherwise the
// result is empty. Titles name the `source`: light or gas.
// - Tilt and heading: "torque_x_NAME_polar", …, "torque_size_NAME_polar"; the tilt in degrees is
// the distance from the centre.
// - Elevation and azimuth over the whole sphere: "torque_x_NAME_from_plus_z", … and
// "…_from_minus_z", the hemispheres seen from outside, in Lambert's equal-area projection.
// Interpolation between the nodes is trigonometric in the azimuth or heading, and cubic in the
// other angle, also across the poles.
std::vector<Map> polar_maps(const WrenchTable& table, const std::string& name,
                            const std::string& source = "light");

// Adds the columns STEM_x_UNIT, STEM_y_UNIT and STEM_z_UNIT to a table.
void add_components(Table& table, const std::string& stem, const std::string& unit,
                    const std::vector<Vec3>& values);

// An angle in degrees without rounding residue: −60 instead of −60.00000000000001.
double stated_deg(double angle_rad);

// The table "wrench_table_NAME" with one row per node (angles in degrees, components and standard
// errors in the body frame), and
// - the largest force and torque, "largest_force_NAME_N" and "largest_torque_NAME_N_m",
// - for two regular axes: smooth maps "force_x_NAME", …, "torque_z_NAME" with nodes at the centres
// of bins,
// - the pictures of polar_maps(),
// - for a single heading or azimuth: the plots "force_NAME" and "torque_NAME" over the tilt or
//   elevation.
Product wrench_table_product(const WrenchTable& table, const std::string& name,
                             const std::string& source = "light");

}  // namespace photorque
