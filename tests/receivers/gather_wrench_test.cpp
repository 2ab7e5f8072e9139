// Force and torque of direct light on bodies, gathered from the surfaces' side.
#include <gtest/gtest.h>

#include "core/constants.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/surfaces/mirrors.h"
#include "receivers/gather/bodies/wrench.h"
#include "tests/receivers/gather_lamps.h"
#include "tests/receivers/receiver_scenes.h"
#include "tests/receivers/sunlight.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::rectangle;
using fixtures::sun;
using fixtures::textbook_N;

WrenchReceiver body_of(const Scene& scene, const Vec3& about_m = Vec3::Zero()) {
  std::vector<uint32_t> all(scene.instances.size());
  for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  return {"body", scene, all, about_m};
}

// As if nothing bounced.
WrenchEstimate direct_of(const WrenchReceiver& receiver, const Gathered& gathered) {
  BinSums sums{receiver.bins(), gathered.direct.replicates, {}, gathered.direct.bound};
  for (int r = 0; r < sums.replicates; ++r) {
    const auto direct = gathered.direct.of(r);
    sums.sums.insert(sums.sums.end(), direct.begin(), direct.end());
    sums.sums.resize(receiver.bins() * static_cast<size_t>(r + 1), 0.0);
  }
  sums.bound.resize(receiver.bins(), 0.0);
  return receiver.direct(sums);
}

// A convex body has no shadows: a box with another surface on each side is exact in every attitude.
TEST(GatherWrench, SunOnABoxIsTheTextbooksForce) {
  Scene scene;
  const Vec3 half_m(0.3, 0.2, 0.5), centre_m(0.1, -0.2, 0.3), about_m(0.05, 0.4, -0.3);
  Mesh box = fixtures::box(centre_m - half_m, centre_m + half_m);
  box.encloses = true;
  add(scene, std::move(box), grey_surface("s", 0.3, 0.25), "box");
  const TraceableScene traceable(scene);
  const WrenchReceiver body = body_of(scene, about_m);
  const Beam beam = sun(0.0);
  const auto gather = WrenchGather::make(traceable, std::span(&beam, 1));
  for (const double tilt_deg : {7.0, 35.0, 70.0, 110.0, 160.0}) {
    const RigidTransform attitude = lab_from_body_at(tilt_deg * degree_rad, 0.6);
    const Gathered gathered = gather->wrench(attitude, body, {});
    EXPECT_EQ(gathered.shadow_rays, 0u);
    const WrenchEstimate found = direct_of(body, gathered);
    const Vec3 travel = attitude.inverse().direction(-Vec3::UnitZ());
    Vec3 force_N = Vec3::Zero(), torque_N_m = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const double sign = travel[axis] < 0.0 ? 1.0 : -1.0;
      const Vec3 normal = sign * Vec3::Unit(axis);
      const double area_m2 = 4.0 * half_m[(axis + 1) % 3] * half_m[(axis + 2) % 3];
      const Vec3 one_N = textbook_N(area_m2, 0.3, 0.25, travel, normal);
      force_N += one_N;
      torque_N_m += (centre_m + half_m[axis] * normal - about_m).cross(one_N);
    }
    EXPECT_LT((found.mean.force_N - force_N).norm(), 1e-9 * force_N.norm()) << tilt_deg;
    EXPECT_LT((found.mean.torque_N_m - torque_N_m).norm(), 1e-9 * torque_N_m.norm()) << tilt_deg;
    EXPECT_LT(found.torque_error_N_m().norm(), 1e-9 * torque_N_m.norm());
  }
}

// A plate above another takes a rectangle out of its light, moved aside by the height times the
// tangent of the light's angle.
TEST(GatherWrench, AShadowTakesItsRectangleOutOfThePlateBelow) {
  Scene scene;
  add(scene, rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)), grey_surface("s", 0.2, 0.3),
      "below");
  add(scene, rectangle(Vec3(0.1, 0.2, 0.5), Vec3(0.6, 0, 0), Vec3(0, 0.4, 0)),
      grey_surface("b", 0.0, 0.0), "above");
  const TraceableScene traceable(scene);
  const WrenchReceiver below("below", scene, {0});
  const Beam beam = sun(0.0);
  const auto gather = WrenchGather::make(traceable, std::span(&beam, 1));
  for (const double tilt_deg : {5.0, 25.0, 40.0}) {
    const RigidTransform attitude = lab_from_body_at(tilt_deg * degree_rad, 0.5);
    const Vec3 travel = attitude.inverse().direction(-Vec3::UnitZ());
    const Vec3 shadow_m = Vec3(0.1, 0.2, 0.5) + 0.5 / -travel.z() * travel;
    const Vec3 per_area_N = textbook_N(1.0, 0.2, 0.3, travel, Vec3::UnitZ());
    const Vec3 force_N = (4.0 - 0.24) * per_area_N;
    const Vec3 torque_N_m = -0.24 * shadow_m.cross(per_area_N);
    const WrenchEstimate found = direct_of(below, gather->wrench(attitude, below, {}));
    const double stated_N = found.force_error_N().norm();
    EXPECT_LT((found.mean.force_N - force_N).norm(), 5.0 * stated_N) << tilt_deg;
    EXPECT_LT((found.mean.torque_N_m - torque_N_m).norm(), 5.0 * found.torque_error_N_m().norm());
    EXPECT_GT(stated_N, 0.0);
    EXPECT_LT(stated_N, 2e-4 * force_N.norm());
  }
}

// Rays are another route, where bodies shade each other and surfaces follow laws of all sorts.
TEST(GatherWrench, AgreesWithRays) {
  Scene scene = fixtures::shaded_square();
  OpticalSurface rough = grey_surface("rough", 0.7, 0.1);
  auto bsdf = std::make_shared<Bsdf>();
  bsdf->specular = rough_mirror(0.3);
  bsdf->reemitted = 0.8;
  bsdf->front_emission = 0.9;
  rough.bsdf = bsdf;
  add(scene, rectangle(Vec3(-0.2, 0.1, 0.3), Vec3(0.2, 0, 0.1), Vec3(0, 0.15, 0)), rough, "rough");
  add(scene, rectangle(Vec3(0.1, -0.15, 0.2), Vec3(0.2, 0, 0), Vec3(0, 0.1, 0.1)),
      grey_surface("glass", 0.1, 0.0, 0.7), "sheet");
  const TraceableScene traceable(scene);
  const WrenchReceiver body = body_of(scene, {0.1, 0.0, -0.2});
  const std::vector<std::vector<Beam>> lights = {
      {fixtures::gaussian_led(0.4, 3.0, {0, 0, 1.5}, {0, 0, -1}),
       fixtures::gaussian_led(0.05, 9.0, {0.3, 0, 1.4}, {-0.2, 0, -1})},
      {sun(3.0)}};
  for (const std::vector<Beam>& beams : lights) {
    const auto gather = WrenchGather::make(traceable, beams);
    const RigidTransform attitude = lab_from_body_at(20 * degree_rad, 0.4);
    const WrenchEstimate own = direct_of(body, gather->wrench(attitude, body, {}));
    const Receiver* const receivers[] = {&body};
    const TraceResult traced = trace(traceable, attitude, beams, receivers, {.rays = 1 << 22});
    const WrenchEstimate rays = body.direct(traced.sums[0]);
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double force_N =
          std::sqrt(rays.covariance(k, k) + own.covariance(k, k)) + 1e-6 * rays.mean.force_N.norm();
      EXPECT_NEAR(own.mean.force_N[k], rays.mean.force_N[k], 5.0 * force_N);
      const double torque_N_m =
          std::sqrt(rays.covariance(3 + k, 3 + k) + own.covariance(3 + k, 3 + k)) +
          1e-6 * rays.mean.torque_N_m.norm();
      EXPECT_NEAR(own.mean.torque_N_m[k], rays.mean.torque_N_m[k], 5.0 * torque_N_m);
    }
    EXPECT_LT(own.force_error_N().norm(), 2e-3 * own.mean.force_N.norm());
  }
}

}  // namespace
}  // namespace photorque
