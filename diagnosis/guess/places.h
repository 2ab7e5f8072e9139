// Coordinates on a circle: a pendulum's bob or a mark on a turntable, seen by a camera.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "attitude/recordings/recording.h"

namespace photorque {

struct Circle {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
  double scatter = 0.0;  // rms distance of the readings from the circle, in units of its radius
};

// The circle on which x_m and y_m lie if they turn back on it at least twice or cover an arc of
// more than 2 rad. The circle is fitted by linear least squares (I. Kåsa, IEEE Trans. Instrum.
// Meas. 25, 8 (1976)).
std::optional<Circle> circle_of(const Recording& recording);

}  // namespace photorque
