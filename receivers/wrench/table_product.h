// A table of wrenches over angles, as results for people and other programs.
#pragma once

#include <string>

#include "core/product.h"
#include "core/wrench.h"

namespace photorque {

// An angle as somebody stated it: −60 and not −60.00000000000001.
double stated_deg(double angle_rad);

// The table "wrench_table_NAME" with a row per node (angles in degrees, components and standard
// errors in the body frame), and
// - the longest force and torque, "largest_force_NAME_N" and "largest_torque_NAME_N_m",
// - for two regular axes: maps "force_x_NAME" … "torque_z_NAME" with nodes at the middles of bins,
//   drawn smooth,
// - the pictures of polar_maps.h,
// - for a single heading or azimuth: the plots "force_NAME" and "torque_NAME" over the tilt or
//   elevation.
Product wrench_table_product(const WrenchTable& table, const std::string& name);

}  // namespace photorque
