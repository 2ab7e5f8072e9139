// A table of wrenches over angles, as results with pictures and for other programs, with pictures
// that show attitudes and directions where they are: discs of tilt and heading, half spheres of
// directions.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"
#include "core/wrench.h"

namespace photorque {

// Smooth maps of the torque's components about body x, y and z, and of its size, on `name`, from a
// table whose headings or azimuths go all the way round in even steps; none from others.
// - Tilt and heading: "torque_x_NAME_polar" …, "torque_size_NAME_polar", the tilt from the middle
// outwards in degrees.
// - Elevation and azimuth over a whole sphere: "torque_x_NAME_from_plus_z" … and
//   "…_from_minus_z", the halves of the sphere as seen from outside, in Lambert's equal areas.
// Between the nodes: trigonometric in the angle around, cubic in the other, through the poles.
// `source`, in titles: light or gas.
std::vector<Map> polar_maps(const WrenchTable& table, const std::string& name,
                            const std::string& source = "light");

// An angle as stated: −60 and not −60.00000000000001.
double stated_deg(double angle_rad);

// The table "wrench_table_NAME" with a row per node (angles in degrees, components and standard
// errors in the body frame), and
// - the longest force and torque, "largest_force_NAME_N" and "largest_torque_NAME_N_m",
// - for two regular axes: maps "force_x_NAME" … "torque_z_NAME" with nodes at the middles of bins,
//   drawn smooth,
// - the pictures of polar_maps(),
// - for a single heading or azimuth: the plots "force_NAME" and "torque_NAME" over the tilt or
//   elevation.
Product wrench_table_product(const WrenchTable& table, const std::string& name,
                             const std::string& source = "light");

}  // namespace photorque
