// Motions that identify the machine of recorded coordinates or rates: the bob of a pendulum or a
// mark on a turntable moves on a circle, and a weight on a spring oscillates about its rest
// position.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "attitude/observation/observation.h"
#include "attitude/recordings/recording.h"

namespace photorque {

struct Circle {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
  double scatter = 0.0;  // rms distance of the readings from the circle, in units of its radius
};

// The circle on which x_m and y_m lie if they turn back on it at least twice or cover an arc of
// more than 2 rad. Its distances from the readings are minimised by a robust regression (Tukey's
// biweight).
std::optional<Circle> circle_of(const Recording& recording);

// A harmonic oscillation.
struct Oscillation {
  double period_s = 0.0;
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  double most_m = 0.0;  // largest deviation from the middle
};

// The oscillation of x_m or y_m, that of the larger deviations, if it passes its middle at least
// seven times at regular intervals of at least three readings, each time from beyond three times
// `noise_m` of x and y. A spring keeps a body long at the turning points: between two passages, the
// mean deviation is 0.64 of the quantile 0.9. It is 0.56 for a body that bounces between two
// elastic walls.
std::optional<Oscillation> oscillation_of(const Recording& recording,
                                          const Eigen::Vector2d& noise_m);

// Whether the rates have no mean, as those of a swing. A free body rotates in one sense about one
// of its principal axes.
bool has_no_mean_rate(const std::vector<Observation>& runs);

// The body axis (0 to 2) that is nearest to the line along which nearly all of the rate lies.
// `across`: the largest rate across this line, as a fraction of that along it. Returns nothing if
// there is no such line.
std::optional<int> axis_of_swing(const std::vector<Observation>& runs, double across);

// The axis with nearly all of the rate; none if several have significant rates.
std::optional<int> only_axis(const std::vector<Observation>& runs);

}  // namespace photorque
