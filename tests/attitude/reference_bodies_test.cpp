// Free and librating bodies from the tests of other programs (shared reference attitude.md,
// sections 5 and 6).
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

AttitudeModel body(const Vec3& moments_kg_m2) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = moments_kg_m2.asDiagonal();
  return model;
}

// Basilisk, test_spacecraft: modified Rodrigues parameters at 10 s.
TEST(ReferenceBody, AgreesWithBasiliskAfterTenSeconds) {
  const AttitudeModel model = body({500, 200, 300});
  const PlatformState start = state_of(model, Quat::Identity(), {0.5, -0.4, 0.7});
  Quat q = propagated(model, start, 10.0).lab_from_body;
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  const Vec3 sigma = q.vec() / (1.0 + q.w());
  EXPECT_LT((sigma - Vec3(3.73034285e-01, -2.39564413e-03, 2.08570797e-01)).norm(), 2e-9);
}

// Orekit, TorqueFreeTest: all orders of the moments, both directions of rotation. The direction of
// the momentum is constant to 1.6e-15 rad there. The limit here permits other rounding errors of
// some twenty steps.
TEST(ReferenceBody, MomentumKeepsItsDirectionForAllOrdersOfTheMoments) {
  std::array<double, 3> moments = {3.0 / 8, 1.0 / 2, 5.0 / 8};
  do {
    const Vec3 moments_kg_m2(moments[0], moments[1], moments[2]);
    const AttitudeModel model = body(moments_kg_m2);
    for (const double sense : {1.0, -1.0}) {
      const Vec3 rate_rad_s = sense * Vec3(0.05, 0.0, 0.04);
      const PlatformState end =
          propagated(model, state_of(model, Quat::Identity(), rate_rad_s), 40.0);
      const Vec3 before = moments_kg_m2.cwiseProduct(rate_rad_s);
      const Vec3 after = end.lab_from_body * moments_kg_m2.cwiseProduct(end.rate_body_rad_s);
      EXPECT_LT(before.normalized().cross(after.normalized()).norm(), 1e-14);
    }
  } while (std::next_permutation(moments.begin(), moments.end()));
}

// orts: I = (10, 10, 15), rate (0.1, 0, 1). In the body the rate rotates about the axis at (I_3 −
// I_1)/I_1 ω_3; in the lab the axis rotates about the momentum at |L|/I_1.
TEST(ReferenceBody, SymmetricTopFollowsItsClosedForm) {
  const Vec3 moments_kg_m2(10, 10, 15);
  const AttitudeModel model = body(moments_kg_m2);
  const PlatformState start = state_of(model, Quat::Identity(), {0.1, 0, 1});
  const Vec3 momentum = moments_kg_m2.cwiseProduct(start.rate_body_rad_s);
  for (const double t_s : {1.0, 10.0, 1000.0}) {
    const PlatformState end = propagated(model, start, t_s);
    const Vec3 rate(0.1 * std::cos(0.5 * t_s), 0.1 * std::sin(0.5 * t_s), 1.0);
    EXPECT_LT((end.rate_body_rad_s - rate).norm(), 1e-13);
    const Vec3 axis =
        Eigen::AngleAxisd(momentum.norm() / 10.0 * t_s, momentum.normalized()) * Vec3::UnitZ();
    EXPECT_LT((end.lab_from_body * Vec3::UnitZ() - axis).norm(), 1e-12);
  }
}

// Tudat, Phobos: ω² = 3 μ/a³ (I_2 − I_1)/I_3, here with a fixed direction of Mars.
TEST(ReferenceBody, PhobosLibratesAsInTudat) {
  AttitudeModel model = body({0.3615, 0.4265, 0.5024});
  const double gradient_1_s2 = 4.282837e13 / std::pow(9376e3, 3);
  model.environment.up_lab = Vec3::UnitX();
  model.environment.gravity_gradient_1_s2 = gradient_1_s2;
  model = with(model, "gravity_gradient");
  const double omega_rad_s = std::sqrt(3.0 * gradient_1_s2 * (0.4265 - 0.3615) / 0.5024);
  const double amplitude_rad = 1e-5;
  const PlatformState start = state_of(model, turned(amplitude_rad, Vec3::UnitZ()));
  const PlatformState quarter = propagated(model, start, pi / 2 / omega_rad_s);
  EXPECT_NEAR(quarter.rate_body_rad_s.z() / (-omega_rad_s * amplitude_rad), 1.0, 1e-9);
  EXPECT_LT(quarter.lab_from_body.angularDistance(Quat::Identity()), 1e-9 * amplitude_rad + 1e-13);
}

}  // namespace
}  // namespace photorque
