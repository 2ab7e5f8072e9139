// Smoothing of a noisy table of force and torque over the directions of light.
//
// Every direction has two estimates from independent rays. For each degree of the spherical
// harmonics, the part that both have in common is the signal, and the rest is noise. Each degree is
// multiplied by the ratio of signal to total power (N. Wiener, Extrapolation, Interpolation, and
// Smoothing of Stationary Time Series, 1949). The error contains the remaining noise and the
// removed part.
#pragma once

#include <span>
#include <vector>

#include "core/numerics/sphere_series.h"
#include "core/wrench.h"

namespace photorque {

// Two estimates of a wrench from independent rays.
struct WrenchPair {
  WrenchComponents first{}, second{};
};

// Force and torque over the sphere.
struct SmoothWrench {
  SphereSeries series;          // six functions
  WrenchComponents error{};     // root mean square over the sphere, per component
  std::vector<double> at_node;  // six numbers for each node of the table
};

// Smooths the values at the nodes of a table with equally spaced azimuths over the whole circle
// (the first may be repeated at the end) and elevations from pole to pole.
SmoothWrench smooth_over_sphere(const WrenchTable& table, std::span<const WrenchPair> wrenches);

}  // namespace photorque
