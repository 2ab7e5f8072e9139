// A body that swings about one axis: the time of its release, and the law of its restoring torque.
#pragma once

#include <vector>

#include "attitude/estimation/axis_readings.h"

namespace photorque {

// A passage of a series through zero.
struct Passage {
  size_t before = 0;     // the last value on the side that is left
  double time_s = 0.0;   // interpolated
  double extreme = 0.0;  // largest magnitude since the passage before
};
// Passages between values of at least a fifth of the extreme before, and at least `least`, on one
// side and on the other. Noise near zero and at rest does not count. The extreme counts as at most
// four times the median size of the values above `least`, so that no outlier hides what follows.
std::vector<Passage> passages(const std::vector<double>& time_s, const std::vector<double>& values,
                              double least);

// First of the rows [first, last) from which on the angle about `axis` swings freely. Before it,
// for example, a hand sets the body swinging.
//
// One law of angle and rate is fitted to the accelerations of local cubics by a robust regression.
// The body swings freely when the residuals of this law stay below three times their usual scatter
// (or the error of the cubics) for a quarter of a period. A rest at the end is ignored.
//
// Returns `first` if the body swings less than three times, if there are too few rows, or if more
// than a quarter of the rows would be left out.
size_t released_at(const Observation& rows, const Vec3& axis, size_t first, size_t last);

// Angles of a swing of which only rates were measured. They are the integral of the rates relative
// to the centre of the swing. The centre is determined between turning points, so that bias and
// noise of the gyro do not accumulate. Empty if the rates pass zero less than four times, or if the
// intervals between differ by a factor of two.
AxisReadings angles_of_swing(const Observation& rows, const Vec3& axis);

// Angles of a body that turns by at least half a turn over a weight. If only rates were measured,
// the angles are their integral, zero at the start. Empty unless the readings show a torque that
// changes once per turn, as a weight exerts it about a level axis. The rates are fitted with time
// integrals of a constant, dry, viscous and quadratic friction, and then also of sine and cosine of
// the angle. The second fit must halve the sum of squares, and
// neighbouring readings must be less than a quarter of a turn apart.
AxisReadings angles_over_weight(const Observation& rows, const Vec3& axis);

// Angles of which only rates were measured: angles_of_swing(), otherwise angles_over_weight().
AxisReadings angles_from_rates(const Observation& rows, const Vec3& axis);

// Whether the angle about `axis` repeatedly passes its mean, by at least a fifth of its largest
// deviation on both sides. For runs without an angle: whether angles_of_swing() finds a swing.
bool swings(const std::vector<Observation>& runs, const Vec3& axis);

// The law of the restoring torque about `axis`. The torque of a weight about a level axis is
// proportional to the sine of the angle from the rest position. The torque of a spring or a twisted
// line is proportional to the angle.
//
// A swing over more than a turn between turning points is that of a spring. Otherwise, the result
// is the law under which the periods depend on the amplitudes with clearly less scatter. If neither
// does, and the readings are dense enough, each law plus friction is fitted to the rates of local
// cubics (integrated over time). The law with the smaller residual is chosen if it reduces χ² by
// more than chance does, for the number of independent residuals that their correlation leaves.
// `unclear` for small swings, for which both laws are equivalent, and for too few readings. Without
// an angle, those of angles_of_swing() are used.
enum class RestoringLaw { unclear, weight, spring };
RestoringLaw restoring_law(const Observation& rows, const Vec3& axis);

}  // namespace photorque
