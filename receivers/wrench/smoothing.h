// A wrench over the directions of light that is known with noise, made smooth.
//
// Every direction is known twice, from independent rays. The parts of each degree of the spherical
// harmonics that both know alike are the wrench's own, the rest is noise: each degree is kept in
// the ratio of the first to all (N. Wiener, Extrapolation, Interpolation, and Smoothing of
// Stationary Time Series, 1949), and the remaining noise and the removed part are the error.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/numerics/sphere_series.h"
#include "core/wrench.h"

namespace photorque {

// A wrench and the same from other rays.
struct TwofoldWrench {
  WrenchComponents first{}, second{};
};

// Force and torque over the sphere.
struct SmoothWrench {
  SphereSeries series;          // six functions
  WrenchComponents error{};     // of each: root mean square over the sphere
  std::vector<double> at_node;  // six numbers for each node of the table
};

// Of the nodes of a table of azimuths evenly all round (the first may be there again after a whole
// turn) and of elevations from pole to pole.
SmoothWrench smooth_over_sphere(const WrenchTable& table, std::span<const TwofoldWrench> wrenches);

}  // namespace photorque
