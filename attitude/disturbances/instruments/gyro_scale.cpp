// A gyro whose readings are proportionally too large or too small on each axis.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::gyro_scale {
namespace {

constexpr VectorKey scale("scale", "three fractions: 0.01 reads 1 % too much");

// A gyro that is farther off is not calibrated at all.
constexpr double largest = 0.5;

// reading − ω = s_i ω_i on each axis.
struct GyroScale final : LawOf<GyroScale> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    for (int i = 0; i < 3; ++i) {
      now.gyro_error_rad_s[i] += own.element(scale, i) * now.inertial_rate_body_rad_s[i];
    }
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<GyroScale, Stage::measurement, scale>(
      {.name = "gyro_scale",
       .summary = "the gyro's axes read too much or too little, in proportion to the rate",
       .screening = {.parametrisations =
                         {{"the gyro's axes read too much or too little in proportion to the rate",
                           {{scale.name, {0.0, 0.0, 0.0}, 0.02, -largest, largest}}}}},
       .budget = {.reason_against = "an error of an instrument: no torque"},
       .instrument = "gyro"});
}

}  // namespace photorque::kinds::gyro_scale
