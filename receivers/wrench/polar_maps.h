// Pictures of a table of wrenches that show attitudes and directions where they are: discs of tilt
// and heading, and half spheres of directions.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"
#include "core/wrench.h"

namespace photorque {

// Smooth maps of the torque's components about body x, y and z on `name`, from a table whose
// headings or azimuths go all the way round in even steps; none from others.
// - Tilt and heading: "torque_x_NAME_polar" …, the tilt from the middle outwards in degrees.
// - Elevation and azimuth over a whole sphere: "torque_x_NAME_from_plus_z" … and
//   "…_from_minus_z", the halves of the sphere as seen from outside, in Lambert's equal areas.
// Between the nodes: trigonometric in the angle around, cubic in the other, through the poles.
std::vector<Map> polar_maps(const WrenchTable& table, const std::string& name);

}  // namespace photorque
