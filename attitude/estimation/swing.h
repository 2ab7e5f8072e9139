// A body that swings about one axis: the instant of its release, and the law that drives it back.
#pragma once

#include "attitude/estimation/axis_readings.h"

namespace photorque {

// The first of the rows [first, last) from which on the angle about `axis` swings freely: a hand
// that set it swinging acts before. Local cubics through a quarter of a period, or nine readings
// where a quarter has fewer, give angle, rate and acceleration; one law of angle and rate (a
// constant, sin, cos and the angle itself, sign, rate, rate |rate|) is fitted to all accelerations,
// robustly (Tukey's biweight). It swings freely from where that law holds for a quarter of a
// period, to three times the usual scatter or a twentieth of the accelerations around. What rests
// at the end does not count. `first` where it swings less than three times or there are too few
// rows, and where that would leave out more than a quarter of the rows.
size_t released_at(const Observation& rows, const Vec3& axis, size_t first, size_t last);

// The angles of a swing that its rates alone show: their integral from the middle of the swing,
// which is found between turning points, so that neither a bias of the gyro nor its noise adds up.
// Empty if the rates do not pass zero four times, or if the times between differ by a factor of
// two.
AxisReadings angles_of_swing(const Observation& rows, const Vec3& axis);

// Whether the angle about `axis` passes its mean again and again, by a fifth of its range on either
// side; of runs without an angle, whether angles_of_swing() finds a swing.
bool swings(const std::vector<Observation>& runs, const Vec3& axis);

// The restoring torque about `axis`: proportional to the sine of the angle from a rest position (a
// weight about a level axis), or to the angle (a spring, a twisted line). The law under which the
// periods depend on the amplitudes with half the scatter. If neither does and there are 28 readings
// a period, beside dry, viscous and quadratic friction each law is fitted to the rates of local
// cubics (integrated over time); the one with the smaller residual, if that gains a tenth of χ² and
// 16 in χ² for as many independent residuals as their correlation leaves. `unclear` for small
// swings, where both are alike, or where there are too few readings. Where there is no angle, those
// of angles_of_swing().
enum class RestoringLaw { unclear, weight, spring };
RestoringLaw restoring_law(const Observation& rows, const Vec3& axis);

}  // namespace photorque
