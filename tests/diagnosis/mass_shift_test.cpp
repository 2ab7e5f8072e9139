// A centre of mass that jumps on a platform that turns quickly: the gain of a jump has a maximum in
// each turn, and a fit does not leave the one where it starts.
#include <gtest/gtest.h>

#include "tests/diagnosis/named.h"
#include "tests/diagnosis/noisy_recording.h"

namespace photorque::rigid_body {
namespace {

TEST(MassShift, IsFoundInTheRightTurn) {
  constexpr double shifted_at_s = 163.0;
  const Vec3 shift_m(1.2e-6, -0.5e-6, 0.4e-6);
  const auto shifted = [&](const State& s) -> Vec3 {
    if (s.time_s < shifted_at_s) return Vec3::Zero();
    return mass_kg * shift_m.cross(s.lab_from_body.conjugate() * Vec3(0, 0, -gravity_m_s2));
  };
  Session session;
  session.rate_rad_s = {0.02, -0.03, 0.9};
  const Diagnosis d = diagnose(nominal_model(), {recorded_with(1, session, shifted)},
                               {recorded_with(2, session, shifted)});
  ASSERT_EQ(kinds_of(d), std::vector<std::string>{"mass_shift"}) << d.sentence;
  const FittedParameter& time = parameter(d, "mass_shift", "time_s");
  EXPECT_NEAR(time.value.front(), shifted_at_s, 5.0 * time.sigma.front() + 0.05);
  EXPECT_LT(time.sigma.front(), 1.0);
}

}  // namespace
}  // namespace photorque::rigid_body
