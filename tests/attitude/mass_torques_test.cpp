// Torques of gravity on a displaced centre of mass.
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"

namespace photorque {
namespace {

// Swings of up to 80 deg about the centre of rotation: the exact period of a physical pendulum is a
// complete elliptic integral. m = 29 kg, d = 81 µm, J = 1.3 kg m² is a published testbed: 47.2 s
// for small swings.
TEST(StaticUnbalance, SwingsWithThePeriodOfAPendulum) {
  AttitudeModel model;
  model.platform.mass_kg = 29.0;
  model.platform.inertia_kg_m2 = Vec3(1.3, 1.3, 1.2).asDiagonal();
  model = with(model, "static_unbalance", "offset_m = [0, 0, -81e-6]");
  const double small_s = 2 * pi * std::sqrt(1.3 / (29.0 * g * 81e-6));
  EXPECT_NEAR(small_s, 47.2, 0.05);
  for (const double amplitude_rad : {1e-3, 0.5, 1.4}) {
    const double period_s = small_s * 2 / pi * std::comp_ellint_1(std::sin(amplitude_rad / 2));
    const PlatformState start = state_of(model, turned(amplitude_rad, Vec3::UnitX()));
    const PlatformState half = propagated(model, start, period_s / 2);
    EXPECT_LT(half.lab_from_body.angularDistance(turned(-amplitude_rad, Vec3::UnitX())), 1e-8);
    EXPECT_LT(half.rate_body_rad_s.norm(), 1e-9);
  }
}

TEST(MassShift, ActsFromItsInstantOn) {
  const AttitudeModel model =
      with(bench_model(), "mass_shift", "time_s = 100, offset_m = [1e-6, 0, 0]");
  const PlatformState start = state_of(model, Quat::Identity());
  EXPECT_LT(propagated(model, start, 100.0).rate_body_rad_s.norm(), 1e-15);
  // Afterwards, the torque m r g about y is nearly constant for a second: θ = ½ α t².
  const PlatformState later = propagated(model, start, 101.0);
  const double acceleration = 7.0 * g * 1e-6 / 0.12;
  EXPECT_NEAR(later.rate_body_rad_s.y() / acceleration, 1.0, 1e-6);
  EXPECT_NEAR(2 * later.lab_from_body.y() / (0.5 * acceleration), 1.0, 1e-6);
}

// Eq. 34: the full charge of the paper's battery with the rounded lithium gives its 2.3e-4 N m at
// zero tilt.
TEST(BatteryDischarge, ReproducesThePaperFromItsCells) {
  const AttitudeModel model =
      with(bench_model(), "battery_discharge",
           "lithium = 'rounded', cell = [{electrodes_m = [0.03225, 0, 0]}]");
  const PlatformState empty = state_of(model, Quat::Identity(), Vec3::Zero(), 0.0, 2.4 * 3600);
  EXPECT_NEAR(torque_body_N_m(model, empty).norm(), 2.3e-4, 0.05e-4);
  EXPECT_EQ(torque_body_N_m(model, Quat::Identity()).norm(), 0.0);
}

// 1 µm per ampere hour at 2 A for half an hour is 1 µm.
TEST(BatteryDischarge, CountsAmpereHours) {
  AttitudeModel model = with(bench_model(), "battery_discharge", "shift_m_per_Ah = [0, 1e-6, 0]");
  model.schedule.append(0.0, {.battery_current_A = 2.0});
  const PlatformState after = state_of(model, Quat::Identity(), Vec3::Zero(), 0.0, 2.0 * 1800);
  EXPECT_NEAR(torque_body_N_m(model, after).x(), -7.0 * g * 1e-6, 1e-12);
}

// Wang, Li and Bao (2006), Acta Aeronautica: with lateral and axial stiffness k_x and k_z the
// torque is (m g)² (1/k_x − 1/k_z) sin θ cos θ. Balancing at zero tilt adds (m g)²/k_z sin θ.
TEST(ElasticSag, AnisoelasticTorqueOfALumpedPlatform) {
  const double weight = 7.0 * g, kx = 4e6, kz = 9e6;
  const AttitudeModel model =
      with(bench_model(), "elastic_sag",
           "compliance_s2 = " + toml(std::array{7.0 / kx, 7.0 / kx, 7.0 / kz}));
  for (const double tilt : {0.05, 0.5, 1.0}) {
    const Vec3 torque = torque_body_N_m(model, turned(tilt, Vec3::UnitY()));
    const double free = weight * weight * (1 / kx - 1 / kz) * std::sin(tilt) * std::cos(tilt);
    const double balanced = free + weight * weight / kz * std::sin(tilt);
    EXPECT_NEAR(torque.y() / balanced, 1.0, 1e-12);
    EXPECT_LT(std::hypot(torque.x(), torque.z()), 1e-15);
  }
}

// ∫ y dm of a clamped beam with an end mass, per unit of gravity. The bending moment gives the
// curvature, the slope and the deflection, each integrated by the trapezoidal rule.
double beam_moment_by_integration(double l, double end_mass, double beam_mass, double EI) {
  constexpr int n = 20000;
  const double dx = l / n;
  double slope = 0, y = 0, sum = 0;
  const auto curvature = [&](double x) {
    const double arm = l - x;
    return (end_mass * arm + beam_mass / l * arm * arm / 2) / EI;
  };
  for (int i = 0; i < n; ++i) {
    const double x = i * dx;
    const double slope_next = slope + dx * 0.5 * (curvature(x) + curvature(x + dx));
    const double y_next = y + dx * 0.5 * (slope + slope_next);
    sum += beam_mass / l * dx * 0.5 * (y + y_next);
    slope = slope_next;
    y = y_next;
  }
  return sum + end_mass * y;
}

// Across the tilted beams, gravity is less than at zero tilt, and so is the deflection.
TEST(ElasticSag, BeamsGiveTheTorqueOfTheirDeflections) {
  const AttitudeModel dumbbell = with(bench_model(), "elastic_sag",
                                      "dumbbell = {length_m = 0.6, end_mass_kg = 2.5, "
                                      "beam_mass_kg = 0.8, bending_stiffness_N_m2 = 900}");
  const AttitudeModel tabletop = with(
      bench_model(), "elastic_sag",
      "tabletop = {length_m = 0.25, total_mass_kg = 3.2, bending_stiffness_N_m2 = 300, count = 4}");
  const double arms_kg_s2 = 2 * beam_moment_by_integration(0.6, 2.5, 0.8, 900.0),
               beams_kg_s2 = 4 * beam_moment_by_integration(0.25, 0.0, 0.8, 300.0);
  for (const double tilt : {0.1, 0.5, 1.0}) {
    const Quat q = turned(tilt, Vec3::UnitY());
    const double of_arms = g * g * arms_kg_s2 * (1.0 - std::cos(tilt)) * std::sin(tilt),
                 of_beams = g * g * beams_kg_s2 * 0.5 * std::sin(2.0 * tilt);
    EXPECT_NEAR(torque_body_N_m(dumbbell, q).y() / of_arms, 1.0, 1e-7);
    EXPECT_NEAR(torque_body_N_m(tabletop, q).y() / of_beams, 1.0, 1e-7);
  }
}

TEST(ElasticSag, RefusesACouplingThatIsNotSymmetric) {
  EXPECT_THROW(make(bench_model(), "elastic_sag",
                    "compliance_s2 = [[1e-7, 1e-8, 0], [0, 1e-7, 0], [0, 0, 1e-7]]"),
               InputError);
}

// The paper's 1.23e-5 N m is for one axis at rest. Three axes add as vectors.
TEST(StepperQuantization, ReproducesThePaper) {
  const std::string usual = "moving_mass_kg = 0.25, lead_m = 2e-3";
  const AttitudeModel single = with(bench_model(), "stepper_quantization",
                                    usual + ", rounding_steps = [0.5, 0, 0, 0, 0, 0, 0, 0]");
  EXPECT_NEAR(torque_body_N_m(single, Quat::Identity()).norm(), 1.23e-5, 0.005e-5);
  const AttitudeModel worst = with(bench_model(), "stepper_quantization", usual);
  EXPECT_NEAR(torque_body_N_m(worst, Quat::Identity()).norm(), std::sqrt(2.0) * 1.226e-5, 0.005e-5);
  EXPECT_THROW(make(bench_model(), "stepper_quantization",
                    usual + ", rounding_steps = [0.6, 0, 0, 0, 0, 0, 0, 0]"),
               InputError);
}

// An acceleration a of the floor has the same effect as a gravity of g − a (equivalence principle).
TEST(FloorVibration, IsGravityOfAnAcceleratedLab) {
  const Vec3 offset_m(2e-6, -1e-6, -3e-5), acceleration(0.3, -0.2, 0.1);
  const AttitudeModel rigid =
      with(bench_model(), "static_unbalance", "offset_m = [2e-6, -1e-6, -3e-5]");
  // Zero frequency and a phase of a quarter turn: a constant acceleration.
  const AttitudeModel vibrating =
      with(rigid, "floor_vibration",
           "acceleration_m_s2 = [0.3, -0.2, 0.1], frequency_Hz = 0, phase = " + toml(pi / 2));
  AttitudeModel heavier = rigid;
  heavier.environment.gravity_lab_m_s2 -= acceleration;
  const PlatformState state = state_of(rigid, turned(0.4, {1, 2, 3}));
  const std::vector<Vec3> parts = disturbance_torques_body_N_m(vibrating, state);
  const Vec3 expected = torque_body_N_m(heavier, state);
  EXPECT_LT((parts[0] + parts[1] - expected).norm(), 1e-15);
}

TEST(FloorVibration, PlaysSpectraAndRecordings) {
  const AttitudeModel base = with(bench_model(), "static_unbalance", "offset_m = [0, 0, -1e-5]");
  const AttitudeModel noisy =
      with(base, "floor_vibration",
           "spectrum = {frequency_Hz = [1, 10], density_m2_s3 = [1e-8, 1e-8], tones = 200}");
  // Torque about x: m · 1e-5 · a_y, whose mean square is 9e-8 by the area of the spectrum.
  double sum = 0;
  constexpr int samples = 1000;
  for (int i = 0; i < samples; ++i) {
    sum += std::pow(torque_body_N_m(noisy, Quat::Identity(), Vec3::Zero(), 0.37 * i).x(), 2);
  }
  EXPECT_NEAR(sum / samples / (std::pow(7.0 * 1e-5, 2) * 9e-8), 1.0, 0.1);

  const auto path = test_file("floor.csv",
                              "t_s,acceleration_x_m_s2,acceleration_y_m_s2,acceleration_z_m_s2\n"
                              "0,0.1,0,0\n1,0.2,0,0\n2,0.3,0,0\n");
  const AttitudeModel recorded =
      with(base, "floor_vibration", "accelerogram_file = " + toml(path) + ", scale = 2");
  EXPECT_NEAR(torque_body_N_m(recorded, Quat::Identity(), Vec3::Zero(), 1.0).y(), 7.0 * 1e-5 * 0.4,
              1e-15);
  EXPECT_EQ(torque_body_N_m(recorded, Quat::Identity(), Vec3::Zero(), 5.0).norm(), 0.0);
}

}  // namespace
}  // namespace photorque
