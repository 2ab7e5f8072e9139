// Readings of the angle or rate of a body about its only axis of rotation, and rates that are
// computed from angles.
#pragma once

#include <optional>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// Readings about the axis; rows without a reading are left out.
struct AxisReadings {
  std::vector<size_t> row;
  std::vector<double> time_s, value;  // rad or rad/s
};

// Angles in the rows [first, last), with whole turns counted.
AxisReadings angles_about(const Observation& rows, const Vec3& axis, size_t first, size_t last);
// The rate of the gyro along the axis in a row; nothing if no axis of the gyro with a part along it
// was read.
std::optional<double> rate_along(const Observation& rows, size_t row, const Vec3& axis);
// Rates in the rows [first, last).
AxisReadings rates_about(const Observation& rows, const Vec3& axis, size_t first, size_t last);

// Whether the body turns less than this in every run: the range of its angles or, of rates alone,
// their mean size times the duration.
bool turns_less(const std::vector<Observation>& runs, const Vec3& axis, double turns);
// Largest number of turns by which a suspension line is twisted.
constexpr double most_turns_of_line = 30.0;

// Coefficients of the cubic of (t − at_s)/unit_s that is fitted to the readings [first, last) minus
// `origin`.
Eigen::Vector4d fitted_cubic(const AxisReadings& read, size_t first, size_t last, double at_s,
                             double unit_s, double origin = 0.0);

// Row in [first, last) at which the body starts to move suddenly after a rest, for example when a
// motor is switched on or the body is released; `first` if there is no such rest.
//
// During the rest, at least five readings scatter about one value (zero for a rate) like noise,
// without a slope. The motion starts at most twelve readings later. From its start on, all readings
// are more than five times the scatter away, on one side. Their slope would move the body by more
// than ten times the scatter during the time of the rest.
size_t start_of_motion(const Observation& rows, const Vec3& axis, size_t first, size_t last);

// Reading of a gyro after the body has come to rest, with its standard error. The last tenth of the
// rates, at least ten readings, scatters about this value without a slope. The value is less than a
// tenth of the largest rate, and some rate differs from it by more than ten times the scatter.
struct ReadingAtRest {
  double rate_rad_s = 0.0, sigma_rad_s = 0.0;
};
std::optional<ReadingAtRest> reading_at_rest(const Observation& rows, const Vec3& axis);

// Whether all rates about the axis are difference quotients of the angle: towards the previous
// reading, the next one, or across both. They must agree to 5 % of the scatter of neighbouring
// quotients. The errors of a second instrument would be independent.
bool is_rate_of_angle(const Observation& rows, const Vec3& axis);
// Removes the rates from the rows.
void drop_rates(Observation& rows);

// The recording with mean rates between the readings instead of the angle, if the angle has fewer
// than nine readings per turn and turns at least ten times in one sense. Such an angle does not
// show the law within a turn. Empty for other recordings, with commands or with other readings of
// the rotation.
std::optional<Recording> with_rates_of_far_turns(const Recording& recording,
                                                 const Platform& platform);

}  // namespace photorque
