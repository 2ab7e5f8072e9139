// Machines of a textbook as people record them: a hand at the start, few readings a period, noise
// of a hundredth. Motions by closed form or by the Runge-Kutta rule of machine_bench.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/diagnosis/machine_bench.h"

namespace photorque {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

std::string about(const std::string& axis, const std::string& noise) {
  return "[platform]\ntopology = \"one_axis\"\naxis = \"" + axis + "\"\n[sensors." + noise + "\n";
}

Channel noisy(const std::string& name, std::vector<double> values, double sigma, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  for (double& value : values) value += noise(random);
  return {name, std::move(values)};
}

void expect_number(const Diagnosis& d, const std::string& kind, const std::string& key,
                   size_t component, double truth) {
  const FittedParameter& p = parameter(d, kind, key);
  EXPECT_NEAR(p.value[component], truth, 5.0 * p.sigma[component]) << kind << ": " << d.sentence;
  EXPECT_LT(p.sigma[component], 0.2 * std::abs(truth)) << kind;
}

// A video of 30 frames a second; a hand moves the pendulum outwards until it lets go after 0.25 s.
TEST(TextbookMachines, APendulumHeldByAHandAtFirst) {
  constexpr double k = 14.6, form = 0.0168, frame_s = 0.0338, released_rad = 1.44;
  const Swing pendulum{k, 0.0, 0.0, form};
  for (const int rows : {211, 423}) {
    std::vector<double> angle_rad = {1.15, 1.16, 1.20, 1.28, 1.35, 1.39, 1.43};
    const std::vector<double> free = pendulum.from(released_rad, frame_s, rows - 7);
    angle_rad.insert(angle_rad.end(), free.begin(), free.end());
    const Diagnosis d = diagnose(
        machine(about("x", "angle]\nnoise_arcsec = 620")),
        {{"video.csv", recording_of(frame_s, {noisy("angle_rad", angle_rad, 0.003, 3)})}}, {});
    EXPECT_THAT(d.warnings, Contains(HasSubstr("a hand holds it"))) << rows << " rows";
    EXPECT_THAT(kinds_of(d), Contains("static_unbalance")) << rows << " rows: " << d.sentence;
    EXPECT_THAT(kinds_of(d),
                testing::AnyOf(Contains("air_pressure_drag"), Contains("air_friction")))
        << rows << " rows: " << d.sentence;
    expect_number(d, "static_unbalance", "offset_m", 2, -k / 9.80665);
  }
}

// θ'' = −k θ − c θ', ten readings a second, twenty a period.
TEST(TextbookMachines, ATorsionPendulumInTwentyReadingsAPeriod) {
  constexpr double k = 10.63, c = 0.43, interval_s = 0.1;
  const double omega = std::sqrt(k - 0.25 * c * c);
  std::vector<double> angle_rad;
  for (int i = 0; i < 200; ++i) {
    const double t = interval_s * i;
    angle_rad.push_back(2.2 * std::exp(-0.5 * c * t) *
                        (std::cos(omega * t) + 0.5 * c / omega * std::sin(omega * t)));
  }
  const Diagnosis d = diagnose(
      machine(about("z", "angle]\nnoise_arcsec = 834")),
      {{"wheel.csv", recording_of(interval_s, {noisy("angle_rad", angle_rad, 0.004, 4)})}}, {});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("tether", "bearing_drag")) << d.sentence;
  expect_number(d, "tether", "stiffness_N_m_per_rad", 0, k);
  expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, c);
}

// ω' = T − c ω from rest: ω = (T/c) (1 − e^(−c t)), with noise of a fiftieth of the final rate. In
// the other recordings the fit of all laws together does not converge, and nothing is named.
TEST(TextbookMachines, AFlywheelThatAMotorSpinsUp) {
  constexpr double torque = 208.0, c = 0.76, interval_s = 0.02, noise_rad_s = 4.9;
  constexpr int recordings = 8, fewest_right = 5;
  std::vector<double> rate_rad_s;
  for (int i = 0; i < 196; ++i) {
    rate_rad_s.push_back(torque / c * (1.0 - std::exp(-c * interval_s * i)));
  }
  int right = 0;
  for (uint64_t seed = 6; seed < 6 + recordings; ++seed) {
    const Diagnosis d =
        diagnose(machine(about("z", "gyro]\nnoise_rad_s = 4.9")),
                 {{"run_up.csv",
                   recording_of(interval_s, {noisy("rate_rad_s", rate_rad_s, noise_rad_s, seed)})}},
                 {});
    std::vector<std::string> kinds = kinds_of(d);
    std::ranges::sort(kinds);
    if (kinds != std::vector<std::string>{"bearing_drag", "room_draft"}) {
      EXPECT_THAT(kinds, testing::IsEmpty()) << d.sentence;
      continue;
    }
    ++right;
    expect_number(d, "room_draft", "torque_lab_N_m", 2, torque);
    expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, c);
  }
  EXPECT_GE(right, fewest_right);
}

// Readings six times a period, with a noise of 3 degrees that no file states.
TEST(TextbookMachines, APendulumInSixReadingsAPeriod) {
  constexpr double k = 8.06, viscous = 0.023, interval_s = 0.4167, noise_rad = 0.052;
  const std::vector<double> angle_rad = Swing{k, 0.0, viscous, 0.0}.from(1.4, interval_s, 59);
  const Diagnosis d = diagnose(
      machine("[platform]\ntopology = \"one_axis\"\naxis = \"x\"\n"),
      {{"frames.csv", recording_of(interval_s, {noisy("angle_rad", angle_rad, noise_rad, 8)})}},
      {});
  EXPECT_THAT(kinds_of(d), Contains("static_unbalance")) << d.sentence;
  expect_number(d, "static_unbalance", "offset_m", 2, -k / 9.80665);
}

}  // namespace
}  // namespace photorque
