// Motion that turns far within the blocks into which a recording is averaged: 3.6 rad/s in blocks
// of a tenth of a second, as 600 s at 160 Hz are. Recordings of a small independent integration.
#include <gtest/gtest.h>

#include "diagnosis/attitude/diagnose.h"
#include "tests/diagnosis/named.h"
#include "tests/diagnosis/noisy_recording.h"

namespace photorque {
namespace {

using namespace rigid_body;

Diagnosis tumbling(bool has_gyro, const Extra& extra) {
  Session session;
  session.rate_rad_s = Vec3(2.0, 0.2, 3.0);
  session.interval_s = 0.01;
  session.duration_s = 100.0;
  session.has_gyro = has_gyro;
  DiagnoseOptions options;
  options.max_blocks = 1000;
  return diagnose(nominal_model(), {recorded_with(1, session, extra)},
                  {recorded_with(2, session, extra)}, options);
}

// Where a mean was taken for a reading at its middle, the curvature of the motion left hundreds of
// times the noise of the gyro, and was called its scale and an error of the inertia.
TEST(FastMotion, LeavesNothingMissing) {
  for (const bool has_gyro : {true, false}) {
    const Diagnosis d = tumbling(has_gyro, nothing_more);
    EXPECT_EQ(d.verdict, Verdict::consistent) << d.sentence;
    // From below the noise bounds it loosely: of a gyro on a body that turns so fast in so few
    // blocks it may be found larger than it is.
    EXPECT_LT(d.chi2_per_sample_after, 1.0 + 5.0 * std::sqrt(2.0 / static_cast<double>(d.samples)));
    EXPECT_GT(d.chi2_per_sample_after, 0.7) << testing::PrintToString(d.warnings);
    EXPECT_GT(d.samples, has_gyro ? 5900 : 2900);
  }
}

// A drag of the bearing beyond what is stated (1.8e-5 +- 0.4e-5 N m s): 2e-5 more.
TEST(FastMotion, KeepsItsNames) {
  const auto drag = [](const State& s) { return Vec3(-2e-5 * s.rate_rad_s); };
  const Diagnosis d = tumbling(true, drag);
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_EQ(d.effects.size(), 1u);
  EXPECT_EQ(d.effects[0].kind, "bearing_drag");
}

// A centre of mass that jumps on a platform that turns quickly: the gain of a jump has a maximum in
// each turn, and a fit does not leave the one where it starts.

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
}  // namespace photorque
