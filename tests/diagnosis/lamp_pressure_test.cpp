// Whether a torque follows the light of the lamps or is there all the time: their recorded current
// decides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/diagnosis/rigid_body_recording.h"

namespace photorque {
namespace {

constexpr double full_A = 0.7, shift_s = 15.0;
const Vec3 torque_lab_N_m(2.5e-5, -1.5e-5, 1e-5);

// Lamps that are dimmed every quarter of a minute.
double brightness(double time_s) {
  constexpr double pattern[] = {0.2, 1.0, 0.7, 0.0, 0.4};
  return pattern[static_cast<size_t>((time_s + 1e-6) / shift_s) % std::size(pattern)];
}

NamedRecording under_lamps(unsigned seed, bool follows_light) {
  NamedRecording named = rigid_body::recorded(seed, [&](const rigid_body::State& s) -> Vec3 {
    const double share = follows_light ? brightness(s.time_s) : 1.0;
    return s.lab_from_body.conjugate() * (share * torque_lab_N_m);
  });
  std::mt19937_64 random(100 + seed);
  std::normal_distribution<double> noise(0.0, 1e-3);
  Channel current{"led_current_A", {}};
  for (const double t : named.recording.time_s) {
    current.values.push_back(full_A * brightness(t) + noise(random));
  }
  named.recording.channels.push_back(current);
  return named;
}

Diagnosis diagnosed(bool follows_light) {
  return diagnose(rigid_body::nominal_model(), {under_lamps(1, follows_light)},
                  {under_lamps(2, follows_light)});
}

const FittedParameter& parameter(const FoundEffect& effect, const std::string& key) {
  const auto found = std::ranges::find(effect.parameters, key, &FittedParameter::key);
  if (found == effect.parameters.end()) throw std::runtime_error(key + " was not fitted");
  return *found;
}

void expect_torque(const FoundEffect& effect, double share) {
  const FittedParameter& torque = parameter(effect, "torque_lab_N_m");
  for (size_t k = 0; k < 3; ++k) {
    const double expected = share * torque_lab_N_m[static_cast<Eigen::Index>(k)];
    EXPECT_NEAR(torque.value[k], expected, 5.0 * torque.sigma[k]);
    EXPECT_LT(torque.sigma[k], 0.1 * torque_lab_N_m.norm());
  }
}

TEST(LampPressure, FollowsTheLight) {
  const Diagnosis d = diagnosed(true);
  ASSERT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].kind, "lamp_pressure");
  EXPECT_THAT(d.effects[0].indistinguishable_from, testing::IsEmpty());
  // The torque belongs to the largest current that was read, noise included.
  const double at_A = parameter(d.effects[0], "led_current_A").value.at(0);
  EXPECT_NEAR(at_A, full_A, 0.01 * full_A);
  expect_torque(d.effects[0], at_A / full_A);
}

TEST(LampPressure, ADraughtDoesNot) {
  const Diagnosis d = diagnosed(false);
  ASSERT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].kind, "room_draft");
  expect_torque(d.effects[0], 1.0);
}

}  // namespace
}  // namespace photorque
