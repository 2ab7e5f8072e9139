// Empirical torques: every form compared with its formula, and the errors of its keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/disturbances/unknown/shape.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

Vec3 torque(const std::string& keys, const Quat& lab_from_body, const Vec3& rate = Vec3::Zero(),
            double time_s = 0.0, double charge_C = 0.0) {
  AttitudeModel model = bench_model();
  model.schedule.append(0.0, {.command_body_N_m = {3e-4, 0.0, 4e-4}});
  model = with(model, "empirical_torque", keys);
  return torque_body_N_m(model, lab_from_body, rate, time_s, charge_C);
}

void expect_near(const Vec3& found, const Vec3& expected) {
  EXPECT_LT((found - expected).norm(), 1e-10 * expected.norm() + 1e-20)
      << found.transpose() << " against " << expected.transpose();
}

// A yaw of 0.7 rad, then a tilt of 0.2 rad about body x: body z tilts to the right of body x.
const Quat attitude = turned(0.7, Vec3::UnitZ()) * turned(0.2, Vec3::UnitX());
const Vec3 vertical = attitude.conjugate() * Vec3::UnitZ();

TEST(EmpiricalTorque, HarmonicsOfTheYaw) {
  expect_near(
      torque(
          "axes = ['vertical'], yaw_orders = [1, 3], coefficients_N_m = [1e-6, 2e-6, -3e-6, 4e-6]",
          attitude),
      (1e-6 * std::cos(0.7) + 2e-6 * std::sin(0.7) - 3e-6 * std::cos(2.1) + 4e-6 * std::sin(2.1)) *
          vertical);
}

// A positive torque about the tilt axis returns body z to the vertical.
TEST(EmpiricalTorque, PowerOfTheTiltRights) {
  const Vec3 found =
      torque("axes = ['lean', 'vertical'], tilt_exponent = 2.5, coefficients_N_m = [3e-6, 2e-6]",
             attitude);
  const double size = std::pow(2.0, 2.5);
  expect_near(found, size * (-3e-6 * Vec3::UnitX() + 2e-6 * vertical));
}

TEST(EmpiricalTorque, WholePowersOfTheRateBrake) {
  const Vec3 rate(0.03, -0.04, 0.12);  // 0.13 rad/s
  const double size = 2e-6 * 0.13 / 0.1 - 1e-6 * std::pow(1.3, 3);
  const Vec3 found = torque(
      "axes = ['rate'], rate_powers = [1, 3], coefficients_N_m = [2e-6, -1e-6]", attitude, rate);
  EXPECT_LT((found + size * rate / 0.13).norm(), 1e-7 * size);  // smoothed below 1e-5 rad/s
}

TEST(EmpiricalTorque, PowerOfTheRateByAxis) {
  const Vec3 rate(0.03, -0.04, 0.12), drag(1e-6, 2e-6, 3e-6);
  const Vec3 found = torque(
      "axes = ['rate_by_axis'], rate_exponent = 1.5, rate_reference_rad_s = 0.2, "
      "coefficients_N_m = [1e-6, 2e-6, 3e-6]",
      attitude, rate);
  const Vec3 expected = -std::pow(0.13 / 0.2, 1.5) * drag.cwiseProduct(rate) / 0.13;
  EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm());
}

TEST(EmpiricalTorque, FadesInBodyAxesAndAboutTheVertical) {
  expect_near(torque("axes = ['body', 'vertical'], time_constant_s = 80.0, "
                     "coefficients_N_m = [1e-6, -2e-6, 3e-6, 5e-6]",
                     attitude, Vec3::Zero(), 120.0),
              std::exp(-1.5) * (Vec3(1e-6, -2e-6, 3e-6) + 5e-6 * vertical));
}

TEST(EmpiricalTorque, PeriodsAndCosinesInTime) {
  expect_near(torque("axes = ['lab'], time_period_s = 40.0, time_orders = [2], "
                     "coefficients_N_m = [1e-6, 0, 0, 0, 2e-6, 3e-6]",
                     attitude, Vec3::Zero(), 7.0),
              attitude.conjugate() * (std::cos(0.7 * pi) * Vec3(1e-6, 0, 0) +
                                      std::sin(0.7 * pi) * Vec3(0, 2e-6, 3e-6)));
  expect_near(torque("axes = ['body'], time_span_s = 100.0, time_cosines = [0, 3], "
                     "coefficients_N_m = [1e-6, 0, 0, 0, 2e-6, 3e-6]",
                     attitude, Vec3::Zero(), 20.0),
              Vec3(1e-6, 0, 0) + std::cos(0.6 * pi) * Vec3(0, 2e-6, 3e-6));
}

TEST(EmpiricalTorque, CrossTalkAndPowersOfTheCommand) {
  // With a reference of 1 N m, the coefficients are fractions of the command.
  expect_near(torque("axes = ['cross_talk'], command_powers = [1], command_reference_N_m = 1.0, "
                     "coefficients_N_m = [0, 0.1, 0.2, 0.3, 0.4, 0]",
                     attitude),
              Vec3(0.1 * 4e-4, 0.2 * 3e-4 + 0.3 * 4e-4, 0.4 * 3e-4));
  expect_near(torque("axes = ['command'], command_powers = [2], coefficients_N_m = 1e-6", attitude),
              25e-6 * Vec3(0.6, 0.0, 0.8));
}

TEST(EmpiricalTorque, ChargeIsHeldBeyondItsRange) {
  const std::string keys =
      "axes = ['body'], charge_powers = [1], charge_reference_Ah = 2.0, charge_range_Ah = [0.0, "
      "1.0], coefficients_N_m = [1e-6, 0, 0]";
  expect_near(torque(keys, attitude, Vec3::Zero(), 0.0, 1800.0), Vec3(0.25e-6, 0, 0));
  // Beyond its range the variable changes by at most a twentieth of the range.
  expect_near(torque(keys, attitude, Vec3::Zero(), 0.0, 36000.0), Vec3(0.525e-6, 0, 0));
  expect_near(torque(keys, attitude, Vec3::Zero(), 0.0, -36000.0), Vec3(-0.025e-6, 0, 0));
}

// Two functions: each term of the first is multiplied by each term of the second.
TEST(EmpiricalTorque, DragThatDependsOnTheYaw) {
  const Vec3 rate(0.03, -0.04, 0.12);
  const Vec3 found = torque(
      "axes = ['rate'], yaw_orders = [2], rate_powers = [1, 2], coefficients_N_m = [1e-6, 2e-6, "
      "3e-6, 4e-6]",
      attitude, rate);
  const double size =
      std::cos(1.4) * (1e-6 * 1.3 + 2e-6 * 1.69) + std::sin(1.4) * (3e-6 * 1.3 + 4e-6 * 1.69);
  EXPECT_LT((found + size * rate / 0.13).norm(), 1e-7 * std::abs(size));
}

// The table reproduces a parabola and its slope exactly, for knots at any distances.
TEST(EmpiricalTorque, TableKeepsParabolas) {
  const std::vector<double> knots = {0.0, 1.0, 1.5, 4.0, 6.0, 6.5};
  const auto parabola = [](double x) { return 1.0 - 2.0 * x + 0.5 * x * x; };
  const SmoothTable table(knots);
  for (double x = 0.0; x <= 6.5; x += 0.05) {
    const SmoothTable::Weights w = table.at(x);
    double value = 0.0, slope = 0.0, sum = 0.0;
    for (size_t k = 0; k < 4; ++k) {
      const double at = parabola(knots[static_cast<size_t>(w.first) + k]);
      value += w.value[k] * at;
      slope += w.slope[k] * at;
      sum += w.value[k];
    }
    EXPECT_NEAR(value, parabola(x), 1e-12);
    EXPECT_NEAR(slope, -2.0 + x, 1e-12);
    EXPECT_NEAR(sum, 1.0, 1e-13);
  }
}

TEST(EmpiricalTorque, TableInTime) {
  const std::string keys =
      "axes = ['vertical'], time_knots_s = [0, 10, 20, 40, 80], coefficients_N_m = [1e-6, 2e-6, "
      "1e-6, 5e-6, 3e-6]";
  expect_near(torque(keys, attitude, Vec3::Zero(), 40.0), 5e-6 * vertical);
  // Half-way between the knots 10 and 20, with the slopes of the parabolas through 0, 10, 20 and
  // 10, 20, 40.
  const double left = 0.0, right = (-1e-6 / 10 * 20 + 4e-6 / 20 * 10) / 30;
  expect_near(torque(keys, attitude, Vec3::Zero(), 15.0),
              (1.5e-6 + 10.0 * (left - right) / 8.0) * vertical);
}

// Each step contains only one cubic. I ω is the sum of integrals for which Simpson's rule is exact.
// Steps across the knots would be many more (126 here).
TEST(EmpiricalTorque, StepsEndAtTheKnotsOfATableInTime) {
  const std::vector<double> knots_s = {0, 10, 20, 30, 40, 50, 60};
  const std::vector<double> torques_N_m = {0, 2e-5, -3e-5, 4e-5, 1e-5, -5e-5, 2e-5};
  const AttitudeModel model = with(bench_model(), "empirical_torque",
                                   "axes = ['vertical'], time_knots_s = " + toml(knots_s) +
                                       ", coefficients_N_m = " + toml(torques_N_m));
  const SmoothTable table(knots_s);
  const auto torque_at = [&](double t_s) {
    const SmoothTable::Weights w = table.at(t_s);
    double sum = 0.0;
    for (size_t k = 0; k < 4; ++k) {
      sum += w.value[k] * torques_N_m[static_cast<size_t>(w.first) + k];
    }
    return sum;
  };
  double impulse_N_m_s = 0.0;
  for (double t_s = 0.0; t_s < 60.0; t_s += 10.0) {
    impulse_N_m_s +=
        10.0 / 6.0 * (torque_at(t_s) + 4.0 * torque_at(t_s + 5.0) + torque_at(t_s + 10.0));
  }
  const Dynamics dynamics(model);
  const double end_s[] = {60.0};
  const Trajectory motion =
      propagate(dynamics, state_of(model, Quat::Identity()), end_s, {.tolerance = 1e-12});
  EXPECT_NEAR(motion.states.back().rate_body_rad_s.z() * 0.19, impulse_N_m_s, 1e-15);
  EXPECT_LE(motion.statistics.steps, 30);
}

// Shapes that are written and read back are unchanged.
TEST(EmpiricalTorque, ShapesAreWrittenAsTheyAreRead) {
  const std::vector<std::string> all = {
      "axes = ['vertical', 'lab'], yaw_orders = [1, 3]",
      "axes = ['lean'], tilt_exponent = 2.5, tilt_reference_deg = 7",
      "axes = ['rate'], rate_knots_rad_s = [0, 0.1, 0.2, 0.25], yaw_orders = [2]",
      "axes = ['body'], time_constant_s = 30, time_range_s = [0, 9]",
      "axes = ['body'], time_period_s = 30, time_orders = [1, 2]",
      "axes = ['body'], time_span_s = 30, time_cosines = [1, 2]",
      "axes = ['command'], command_powers = [1, 2]"};
  for (const std::string& keys : all) {
    const EmpiricalShape shape = read_shape(settings_of(keys));
    std::string again;
    for (const auto& [key, value] : shape_as_written(shape)) {
      again += (again.empty() ? "" : ", ") + key + " = " + value;
    }
    for (const MotionFunction& f : shape.functions) {
      if (!f.own_key().empty()) again += ", " + f.own_key() + " = " + toml(f.own);
    }
    const EmpiricalShape found = read_shape(settings_of(again));
    EXPECT_EQ(shape_as_written(found), shape_as_written(shape));
    EXPECT_EQ(found.coefficients(), shape.coefficients());
    EXPECT_GT(shape.coefficients(), 0u);
  }
}

std::string complaint(const std::string& keys) {
  return refusal_of([&] { make(bench_model(), "empirical_torque", keys); });
}

TEST(EmpiricalTorque, TakesTheOldNameOfTheYaw) {
  const auto torque_by = [](const std::string& key) {
    return torque("axes = ['vertical'], " + key + " = [3], coefficients_N_m = [1e-6, 2e-6]",
                  attitude);
  };
  EXPECT_EQ(torque_by("heading_orders"), torque_by("yaw_orders"));
}

TEST(EmpiricalTorque, ReportsMistakesInItsKeys) {
  const std::string about = "axes = ['vertical'], ", two = "coefficients_N_m = [1e-6, 2e-6]",
                    yaw = "yaw_orders = [3], ";
  EXPECT_EQ(complaint(about + yaw + two), "");
  const std::pair<std::string, std::string> cases[] = {
      {about + two, "one or two"},
      {yaw + two, "axes"},
      {"axes = ['sideways'], " + yaw + two, "sideways"},
      {about + yaw + "coefficients_N_m = [1e-6]", "an array of 2 numbers"},
      {about + "yaw_orders = [2.5], " + two, "whole numbers"},
      {"axes = ['lean'], " + yaw + two, "without a function of the tilt"},
      {about + "tilt_exponent = 2, tilt_powers = [1], " + two, "one function of a variable"},
      {about + "time_knots_s = [0, 3, 2, 5], " + two, "rise"},
      {about + "time_constant_s = -3, " + two, "time_constant_s"},
  };
  for (const auto& [keys, words] : cases) EXPECT_THAT(complaint(keys), testing::HasSubstr(words));
}

}  // namespace
}  // namespace photorque
