// Torques of fields: magnetic field, gravity gradient, rotation of the Earth, light.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/recordings/recording.h"
#include "core/constants.h"
#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"

namespace photorque {
namespace {

// 0.1 A m² across 50 µT: 5e-6 N m.
TEST(MagneticDipole, IsDipoleCrossField) {
  AttitudeModel model = bench_model();
  model.environment.magnetic_field_lab_T = {0, 5e-5, 0};
  model = with(model, "magnetic_dipole", "dipole_A_m2 = [0.1, 0, 0]");
  const Vec3 torque = torque_body_N_m(model, Quat::Identity());
  EXPECT_LT((torque - Vec3(0, 0, 5e-6)).norm(), 1e-20);
}

// A compass needle about the vertical: the frequency √(m B_h / J) of small swings around north.
TEST(MagneticDipole, SwingsLikeACompass) {
  AttitudeModel model = bench_model();
  model.environment.magnetic_field_lab_T = {0, 2e-5, 0};
  model = with(model, "magnetic_dipole",
               "loop = [{current_A = 0.5, turns = 20, area_m2 = [0, 0.01, 0]}]");
  const double half_period_s = pi * std::sqrt(0.19 / (0.1 * 2e-5));
  const PlatformState start = state_of(model, turned(1e-4, Vec3::UnitZ()));
  const PlatformState half = propagated(model, start, half_period_s);
  EXPECT_LT(half.lab_from_body.angularDistance(turned(-1e-4, Vec3::UnitZ())), 1e-11);
}

TEST(HelmholtzCage, CancelsPlaysAndErrs) {
  const AttitudeModel base = bench_model();
  const Vec3 m(0.02, 0.03, -0.01);
  const auto torque = [&](const std::string& cage, double t) {
    const AttitudeModel model = with(with(base, "helmholtz_cage", cage), "magnetic_dipole",
                                     "dipole_A_m2 = [0.02, 0.03, -0.01]");
    return torque_body_N_m(model, Quat::Identity(), Vec3::Zero(), t);
  };
  EXPECT_LT(torque("", 5).norm(), 1e-20);
  const Vec3 uncancelled = m.cross(base.environment.magnetic_field_lab_T);
  EXPECT_LT((torque("gain_error = -0.1", 5) - 0.1 * uncancelled).norm(), 1e-20);
  EXPECT_LT((torque("field_lab_uT = [10, 0, 0]", 5) - m.cross(Vec3(1e-5, 0, 0))).norm(), 1e-20);

  const CircularOrbit orbit{.radius_m = 6371.2e3 + 500e3, .inclination_rad = 0.9};
  const Vec3 there_T = orbit_field_T(orbit, 2026.0, 6000, 20).at(1230.0);
  const std::string played =
      "orbit = {altitude_km = 500, inclination_rad = 0.9, date_year = 2026, duration_s = 6000}";
  EXPECT_LT((torque(played, 1230.0) - m.cross(there_T)).norm(), 1e-18);
}

TEST(HelmholtzCage, PlaysAFile) {
  const auto path = test_file(
      "field.csv", "t_s,field_x_T,field_y_T,field_z_T\n0,0,0,0\n10,1e-5,0,0\n20,2e-5,0,0\n");
  const AttitudeModel model =
      with(with(bench_model(), "helmholtz_cage", "field_file = " + toml(path)), "magnetic_dipole",
           "dipole_A_m2 = [0, 0.1, 0]");
  const Vec3 torque = torque_body_N_m(model, Quat::Identity(), Vec3::Zero(), 15.0);
  EXPECT_LT((torque - Vec3(0, 0, -1.5e-6)).norm(), 1e-18);
}

// With a table that is linear in the direction of the light, the parts of the planet act as their
// sum. For a uniformly glowing planet this is M (R/r)² from straight below, at any attitude.
TEST(PlanetLight, AnEvenlyGlowingPlanetActsAsOneLightFromBelow) {
  const std::string path = sphere_table();
  const AttitudeModel in_orbit =
      with(bench_model(), "orbit", "altitude_m = 550e3, inclination_deg = 97.6");
  const auto planet = [&](const char* changed, double value) {
    return with(in_orbit, "planet_light",
                "table = " + toml(path) +
                    ", sun_direction = [0.3, 0.9, 0.2], zonal = false, albedo = 0.0, " + changed +
                    " = " + toml(value));
  };
  const double ratio = 6371.2 / (6371.2 + 550.0);
  const Quat attitude = turned(0.8, {1, -2, 0.5});
  const CircularOrbit orbit{.radius_m = 6921.2e3, .inclination_rad = 97.6 * degree_rad};
  const Vec3 towards = attitude.conjugate() * -orbit.up(900.0);
  const Vec3 expected = 0.68 / 4.0 * ratio * ratio * (sphere_table_torque_N_m(towards));
  const PlatformState state = state_of(in_orbit, attitude, Vec3::Zero(), 900.0);
  const Vec3 found = torque_body_N_m(planet("scale", 1.0), state);
  EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm());
  // With a table for twice the light, the torque is half.
  const Vec3 half = torque_body_N_m(planet("table_irradiance_W_m2", 2722.0), state);
  EXPECT_LT((half - 0.5 * found).norm(), 1e-12 * found.norm());
}

// Basilisk's gravity-gradient test case (reference values recomputed from its orbit and attitude).
TEST(GravityGradient, AgreesWithBasilisk) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = Vec3(500, 800, 350).asDiagonal();
  const Vec3 position_m(-2816801.601023, 5248174.846916, 3677157.264677);
  model.environment.up_lab = position_m.normalized();
  model.environment.gravity_gradient_1_s2 = 398600.436e9 / std::pow(position_m.norm(), 3);
  model = with(model, "gravity_gradient");
  // Modified Rodrigues parameters (0.1, 0.2, −0.3) of the body in the inertial frame.
  const Vec3 sigma(0.1, 0.2, -0.3);
  const double s2 = sigma.squaredNorm();
  const Vec3 v = 2 * sigma / (1 + s2);
  const Quat q((1 - s2) / (1 + s2), v.x(), v.y(), v.z());
  const Vec3 expected(-5.337578596847e-05, 1.255502419919e-04, 1.361858926892e-04);
  EXPECT_LT((torque_body_N_m(model, q) - expected).norm(), 1e-15);
}

// Libration at a fixed point of the orbit: ω² = 3 n² (I_y − I_x)/I_z, period 3762.29 s (orts).
TEST(GravityGradient, LibratesWithTheClosedFormPeriod) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = Vec3(10, 30, 25).asDiagonal();
  model.environment.up_lab = Vec3::UnitX();
  model.environment.gravity_gradient_1_s2 = 398600.4418e9 / std::pow(7000e3, 3);
  model = with(model, "gravity_gradient");
  const double period_s = 3762.291311808465;
  const double amplitude_rad = 1e-4;
  const PlatformState start = state_of(model, turned(amplitude_rad, Vec3::UnitZ()));
  const PlatformState quarter = propagated(model, start, period_s / 4);
  EXPECT_LT(quarter.lab_from_body.angularDistance(Quat::Identity()), 1e-10);
  EXPECT_NEAR(quarter.rate_body_rad_s.z() / (-0.001670042212696011 * amplitude_rad), 1.0, 1e-7);
}

// On the ground: 3 g/R (I_i − I_j)/2 sin 2θ; 6.9e-7 N m for a difference of 0.3 kg m² at 45 deg.
TEST(GravityGradient, OnTheGround) {
  AttitudeModel model = bench_model();
  model.platform.inertia_kg_m2 = Vec3(1.3, 1.3, 1.0).asDiagonal();
  model = with(model, "gravity_gradient");
  EXPECT_NEAR(torque_body_N_m(model, turned(pi / 4, Vec3::UnitX())).norm(), 6.9e-7, 0.05e-7);
}

// A body at rest relative to the stars rotates once per sidereal day in the lab, for any inertia.
TEST(EarthRotation, BodyAtRestAmongTheStarsTurnsBackward) {
  const AttitudeModel model = with(bench_model(), "earth_rotation");
  const Vec3 earth = model.environment.earth_rate_lab_rad_s;
  const Quat start = turned(0.7, {1, 2, -1});
  const double time_s = 30000;
  const PlatformState end =
      propagated(model, state_of(model, start, start.conjugate() * -earth), time_s);
  const Quat expected = turned(-earth.norm() * time_s, earth) * start;
  EXPECT_LT(end.lab_from_body.angularDistance(expected), 1e-9);
}

// Every free motion conserves the angular momentum in inertial axes. With a rotor on board, as in a
// gyrocompass, the sum of both momenta is conserved.
TEST(EarthRotation, KeepsMomentumAmongTheStars) {
  const AttitudeModel plain = bench_model();
  const AttitudeModel rotor = with(plain, "rotor_momentum", "momentum_N_m_s = [0.05, -0.02, 0.03]");
  for (const auto& [model, spin_body_N_m_s] :
       {std::pair{with(plain, "earth_rotation"), Vec3(0, 0, 0)},
        {with(rotor, "earth_rotation"), Vec3(0.05, -0.02, 0.03)}}) {
    const Vec3 earth = model.environment.earth_rate_lab_rad_s;
    const auto momentum = [&](const PlatformState& s) -> Vec3 {
      const Vec3 inertial_body = s.rate_body_rad_s + s.lab_from_body.conjugate() * earth;
      return turned(earth.norm() * s.time_s, earth) *
             (s.lab_from_body * (model.platform.inertia_kg_m2 * inertial_body + spin_body_N_m_s));
    };
    const PlatformState start = state_of(model, turned(0.4, {1, 0, 1}), {0.05, -0.02, 0.04});
    const PlatformState end = propagated(model, start, 5000);
    EXPECT_LT((momentum(end) - momentum(start)).norm(), 1e-11 * momentum(start).norm());
  }
}

// The reading of a north-finding gyro at rest: 15.041 deg/h.
TEST(EarthRotation, GyroAtRestReadsFifteenDegreesPerHour) {
  const AttitudeModel model = with(bench_model(), "earth_rotation");
  const PlatformState state = state_of(model, turned(0.3, {0, 1, 1}));
  std::vector<Lanes> y;
  for (const double x : to_vector(state)) y.emplace_back(x);
  const Dynamics dynamics(model);
  const Dynamics::Instants now = dynamics.at(Lanes(0.0), {}, y.data());
  const Vec3 reading(now.gyro_rad_s[0][0], now.gyro_rad_s[1][0], now.gyro_rad_s[2][0]);
  EXPECT_NEAR(reading.norm() / degree_rad * 3600, 15.041, 0.001);
}

class LightTable : public testing::Test {
 protected:
  // A black disc of 0.1 m² at z = 0.2 m above the centre, facing body z, under a vertical beam of
  // 1000 W/m² that is wider than it: F = −(P/c) A cos θ up, T = r × F.
  static Vec3 closed_form(const Vec3& up_body) {
    return Vec3(0, 0, 0.2).cross(
        Vec3(-1000 / speed_of_light_m_s * 0.1 * std::max(up_body.z(), 0.0) * up_body));
  }
  void SetUp() override {
    std::ofstream file(path_);
    file.precision(17);
    file << "heading_deg,tilt_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n";
    for (int heading = -180; heading <= 180; heading += 10) {
      for (int tilt = 0; tilt <= 60; tilt += 3) {
        const double t = tilt * degree_rad, h = heading * degree_rad;
        const Vec3 torque =
            closed_form({-std::sin(t) * std::cos(h), -std::sin(t) * std::sin(h), std::cos(t)});
        file << heading << ',' << tilt << ',' << torque.x() << ',' << torque.y() << ','
             << torque.z() << '\n';
      }
    }
  }

  std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) / "light.csv";
};

TEST_F(LightTable, TorqueFollowsTheTableAtAnyAttitude) {
  const AttitudeModel model =
      with(bench_model(), "radiation_pressure", "table = " + toml(path_) + ", scale = 1.5");
  for (const Quat& q : {turned(0.3, {1, 2, 0}), turned(0.9, {-2, 1, 0.4}), turned(2.0, {0.1, 0, 1}),
                        Quat::Identity()}) {
    const Vec3 expected = 1.5 * closed_form(q.conjugate() * Vec3::UnitZ());
    // The table interpolates a torque of 1e-7 N m over 10 deg.
    EXPECT_LT((torque_body_N_m(model, q) - expected).norm(), 1e-11);
  }
}

TEST_F(LightTable, NamesAMissingFile) {
  EXPECT_THROW(make(bench_model(), "radiation_pressure", "table = '/nowhere/table.csv'"),
               InputError);
}

// The current of the lamps in the schedule, and the torque that is proportional to it.

Schedule schedule_of(const std::string& rows) {
  return read_command_file(test_file("lamps.csv", "t_s,led_current_A\n" + rows));
}

TEST(LampCurrent, HoldsUntilItChangesByMoreThanItsNoise) {
  const Schedule s =
      schedule_of("0,0.700\n1,0.702\n2,0.698\n3,\n4,0.349\n5,0.351\n6,-0.001\n7,0.7\n");
  const double expected_A[] = {0.6995, 0.6995, 0.6995, 0.6995, 0.35, 0.35, 0.0, 0.7};
  for (int t = 0; t < 8; ++t) {
    EXPECT_DOUBLE_EQ(s.at(t).led_current_A, expected_A[t]) << t;
    EXPECT_EQ(s.at(t).lamps_as_stated, 0.0);
  }
  // One entry of the schedule for each change.
  EXPECT_EQ(s.time_s.size(), 4u);
}

TEST(LampCurrent, IsNotKnownWithoutAChannel) {
  EXPECT_EQ(ZeroOrderHold{}.lamps_as_stated, 1.0);
  EXPECT_EQ(ZeroOrderHold{}.led_current_A, 0.0);
}

// Half the current gives half the torque, along lab axes. An unknown current gives the whole
// torque.
TEST(LampPressureLaw, IsProportionalToTheCurrent) {
  const auto torque_body = [](const ZeroOrderHold& held) {
    AttitudeModel model = bench_model();
    model.disturbances.clear();
    model.schedule.append(0.0, held);
    model =
        with(model, "lamp_pressure", "torque_lab_N_m = [1e-5, -2e-5, 3e-5], led_current_A = 0.7");
    // After a quarter turn about the vertical, lab x is the body's −y and lab y its x.
    return torque_body_N_m(model, turned(0.5 * pi, Vec3::UnitZ()));
  };
  const Vec3 half = torque_body({.led_current_A = 0.35, .lamps_as_stated = 0.0}),
             unknown = torque_body({}), dark = torque_body({.lamps_as_stated = 0.0});
  EXPECT_LT((half - Vec3(-1e-5, -0.5e-5, 1.5e-5)).norm(), 1e-19);
  EXPECT_LT((unknown - Vec3(-2e-5, -1e-5, 3e-5)).norm(), 1e-19);
  EXPECT_EQ(dark.norm(), 0.0);
}

}  // namespace
}  // namespace photorque
