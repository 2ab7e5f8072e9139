// Drag torques: spin-downs about the vertical compared with their closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/disturbances/air/external_air.h"
#include "attitude/disturbances/bearing/air_bearing.h"
#include "core/constants.h"
#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

constexpr double J = 0.19;  // of the bench platform about z

double rate_after(const AttitudeModel& model, double start_rad_s, double time_s) {
  return propagated(model, state_of(model, Quat::Identity(), {0, 0, start_rad_s}), time_s)
      .rate_body_rad_s.z();
}

TEST(BearingDrag, SocketAxisIsTheLabVertical) {
  const AttitudeModel model =
      with(bench_model(), "bearing_drag", "axial_N_m_s = 1e-5, transverse_N_m_s = 3e-5");
  const Quat q = turned(0.8, {1, -2, 0.5});
  const auto lab_torque = [&](const Vec3& rate_lab) -> Vec3 {
    return q * torque_body_N_m(model, q, q.conjugate() * rate_lab);
  };
  EXPECT_LT((lab_torque({0, 0, 0.2}) - Vec3(0, 0, -2e-6)).norm(), 1e-18);
  EXPECT_LT((lab_torque({0.2, 0, 0}) - Vec3(-6e-6, 0, 0)).norm(), 1e-18);
}

// The drag of the film from the geometry, with the rated gap, the gap of a spring and the gap at
// which supply and film balance.
TEST(BearingDrag, TakesItsFilmFromTheSocket) {
  const AttitudeModel base = bench_model();
  const double weight_N = 7.0 * standard_gravity_m_s2;
  const auto axial = [&](const std::string& film) {
    return make(base, "bearing_drag",
                "socket = {radius_mm = 31.7, half_angle_deg = 45, " + film + "}")
        .parameters[0]
        .value;
  };
  // The textbook form: 2πμR⁴/h (2/3 − cos a + cos³a/3).
  const double c = std::cos(pi / 4);
  const double at_5um =
      2 * pi * 1.813e-5 * std::pow(0.0317, 4) / 5e-6 * (2.0 / 3 - c + c * c * c / 3);
  EXPECT_NEAR(axial("gap_um = 5") / at_5um, 1.0, 1e-12);
  const double softer =
      axial("gap_um = 5, rated_load_N = " + toml(weight_N + 100) + ", stiffness_N_m = 2e7");
  EXPECT_NEAR(softer / at_5um, 0.5, 1e-9);
  const double gap_m =
      gap_under_load_m({0.0317, pi / 4, 0, 6 * degree_rad}, {6.5e5, 2e-8, 0.8},
                       {base.environment.air_pressure_Pa, base.environment.air_temperature_K,
                        base.environment.air_viscosity_Pa_s},
                       weight_N);
  const double fed = axial("recess_half_angle_deg = 6, supply_bar = 6.5, hole_area_mm2 = 0.02");
  EXPECT_NEAR(fed / at_5um, 5e-6 / gap_m, 0.01);  // the recess has no shear: slightly less
  EXPECT_NEAR(axial("recess_half_angle_deg = 6, supply_Pa = 6.5e5, hole_area_m2 = 2e-8") / fed, 1.0,
              1e-12);
  EXPECT_THROW(axial("supply_bar = 6.5, hole_area_mm2 = 0.02"), InputError);
}

TEST(DryFriction, BrakesUniformlyAndStops) {
  const AttitudeModel model = with(bench_model(), "dry_friction", "torque_N_m = 2e-6");
  EXPECT_NEAR(rate_after(model, 0.1, 5000), 0.1 - 2e-6 * 5000 / J, 1e-8);
  EXPECT_LT(std::abs(rate_after(model, 0.01, 5000)), 1e-9);
}

// ω' = −(k/J) ω^1.5: 1/√ω grows linearly.
TEST(AirFriction, DecaysWithPowerThreeHalves) {
  const AttitudeModel model = with(bench_model(), "air_friction", "coefficient = 3.3e-5");
  const double root = 1 / std::sqrt(0.2) + 3.3e-5 / (2 * J) * 5000;
  EXPECT_NEAR(rate_after(model, 0.2, 5000) * root * root, 1.0, 1e-9);
}

// ω' = −(k/J) ω²: 1/ω grows linearly.
TEST(AirPressureDrag, DecaysWithTheSquare) {
  const AttitudeModel model = with(bench_model(), "air_pressure_drag", "coefficient_N_m_s2 = 7e-4");
  EXPECT_NEAR(rate_after(model, 0.2, 5000) * (1 / 0.2 + 7e-4 / J * 5000), 1.0, 1e-9);
}

// A disc of 0.3 m at 1 rpm, both faces, by C_M = 3.87/√Re, and two boxes with c_d = 1.
TEST(AirDrag, SumsThePartsOfThePlatform) {
  const AttitudeModel base = bench_model();
  const double rho = base.environment.air_density_kg_m3,
               nu = base.environment.air_viscosity_Pa_s / rho;
  const double rate = 2 * pi / 60;
  const std::string parts =
      "part = [{shape = 'disc', radius_m = 0.3}, {shape = 'blunt_face', count = 2, "
      "area_m2 = 0.01, distance_m = 0.25, drag_coefficient = 1}]";
  const AttitudeModel friction = with(base, "air_friction", parts);
  const double reynolds = rate * 0.09 / nu;
  const double expected = 3.87 / std::sqrt(reynolds) * 0.5 * rho * rate * rate * std::pow(0.3, 5);
  EXPECT_NEAR(-torque_body_N_m(friction, Quat::Identity(), {0, 0, rate}).z() / expected, 1.0, 1e-3);
  const AttitudeModel form = with(base, "air_pressure_drag", parts);
  const double speed = rate * 0.25;
  EXPECT_NEAR(-torque_body_N_m(form, Quat::Identity(), {0, 0, rate}).z() /
                  (2 * 0.5 * rho * speed * speed * 0.01 * 0.25),
              1.0, 1e-12);
}

// The power lost is k |ω × B|²: k B² ω² for a rotation perpendicular to the field, zero along it.
TEST(EddyDamping, BrakesOnlyAcrossTheField) {
  const AttitudeModel model = with(bench_model(), "eddy_damping", "coefficient_N_m_s_per_T2 = 40");
  const Vec3 field = model.environment.magnetic_field_lab_T;
  const Vec3 along = 0.3 * field.normalized();
  const Vec3 across = 0.3 * field.cross(Vec3::UnitX()).normalized();
  EXPECT_LT(torque_body_N_m(model, Quat::Identity(), along).norm(), 1e-22);
  const Vec3 torque = torque_body_N_m(model, Quat::Identity(), across);
  EXPECT_LT((torque + 40 * field.squaredNorm() * across).norm(), 1e-20);
}

}  // namespace
}  // namespace photorque
