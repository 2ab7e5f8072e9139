#include "attitude/recordings/wheel_speeds.h"

#include <algorithm>
#include <cmath>

namespace photorque {

std::vector<WheelSpeeds> wheel_speeds(const Recording& recording) {
  const Channel* wheel[3] = {recording.find("wheel_x_rad_s"), recording.find("wheel_y_rad_s"),
                             recording.find("wheel_z_rad_s")};
  std::vector<WheelSpeeds> knots;
  if (wheel[0] == nullptr && wheel[1] == nullptr && wheel[2] == nullptr) return knots;
  constexpr size_t most_knots = 400;
  const size_t rows = recording.rows();
  const size_t together = (rows + most_knots - 1) / most_knots;
  for (size_t first = 0; first < rows; first += together) {
    const size_t last = std::min(rows, first + together);
    WheelSpeeds knot;
    for (size_t i = first; i < last; ++i) knot.from_s += recording.time_s[i];
    knot.from_s /= static_cast<double>(last - first);
    for (int k = 0; k < 3; ++k) {
      double sum = 0.0, count = 0.0;
      for (size_t i = first; wheel[k] != nullptr && i < last; ++i) {
        if (std::isnan(wheel[k]->values[i])) continue;
        sum += wheel[k]->values[i];
        count += 1.0;
      }
      // A block without a reading goes on as the one before it.
      const double before = knots.empty() ? 0.0 : knots.back().speed_rad_s[k];
      knot.speed_rad_s[k] = count > 0.0 ? sum / count : before;
    }
    knots.push_back(knot);
  }
  for (size_t i = 0; i + 1 < knots.size(); ++i) {
    knots[i].acceleration_rad_s2 =
        (knots[i + 1].speed_rad_s - knots[i].speed_rad_s) / (knots[i + 1].from_s - knots[i].from_s);
  }
  return knots;
}

}  // namespace photorque
