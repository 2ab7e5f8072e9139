// Small parts far from the body's origin: single precision must not see the distance.
#include <gtest/gtest.h>

#include <numeric>

#include "receivers/gather/bodies/sunlit_body.h"
#include "receivers/gather/gather.h"
#include "tests/receivers/sunlight.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::rectangle;

constexpr double far_m = 1e4, side_m = 1e-3;

// Parts of a millimetre that mirror, scatter and shade, about a point.
Scene small_scene(const Vec3& at_m) {
  Scene scene;
  const auto put = [&](const Vec3& middle, const Vec3& u, const Vec3& v,
                       const OpticalSurface& surface, const char* name) {
    add(scene, rectangle(at_m + side_m * middle, side_m * u, side_m * v), surface, name);
  };
  put({0, 0, 0}, {0.5, 0, 0.05}, {0, 0.5, 0}, grey_surface("grey", 0.3, 0.4), "receiver");
  put({-0.8, 0, 0.4}, {0, 0.4, 0}, {0.1, 0, 0.4}, grey_surface("mirror", 0.9, 0.0), "mirror");
  put({0.3, 0.2, 0.7}, {0.1, 0, 0}, {0, 0.15, 0}, grey_surface("black", 0.0, 0.0), "shade");
  return scene;
}

struct Traced {
  std::vector<Vec3> hits_m;  // from the middle of the small scene
  PowerBalance balance;
  std::vector<Estimate> bins_W_m2;
};

Traced trace_small(const Vec3& at_m, const RigidTransform& lab_from_body, const Beam& beam) {
  const Scene scene = small_scene(at_m);
  const TraceableScene traceable(scene);
  const FluxMapReceiver map = fixtures::map_of(scene, 8);
  const Receiver* const receivers[] = {&map};
  Traced found;
  TraceOptions options{.rays = 1 << 15, .replicates = 8, .threads = 1};
  options.observe = [&](const HitOrigin&, const Hits& hits) {
    for (int i = 0; i < hits.count; ++i) {
      found.hits_m.push_back(hits.position_at_m(static_cast<size_t>(i)) - at_m);
    }
  };
  const TraceResult result =
      trace(traceable, lab_from_body, std::span(&beam, 1), receivers, options);
  found.balance = result.power_balance;
  found.bins_W_m2 = map.flux_map(result.sums[0]).incident.per_bin_W_m2;
  return found;
}

// A lamp, a body and its light that are moved by 10 km: every hit stays at its place to 1e-6 of a
// part, and powers, maps, forces and torques are equal. The body is turned about its origin.
TEST(FarScene, DistanceChangesNeitherHitsNorPowersNorForces) {
  const Vec3 far_at_m(far_m, -7e3, 3e3);
  const RigidTransform turned{Quat(Eigen::AngleAxisd(0.4, Vec3(1, -2, 0.5).normalized())),
                              Vec3::Zero()};
  struct Case {
    const char* name;
    const char* kind;
    SettingsNode::Table keys;
  };
  const Case cases[] = {{"led",
                         "led",
                         {{"power_W", {1.0}},
                          {"aperture_diameter_m", {side_m}},
                          {"profile", {"gaussian"}},
                          {"fwhm_deg", {20.0}}}},
                        {"parallel", "sun", {{"angular_radius_deg", {0.0}}}},
                        {"disc", "sun", {{"angular_radius_deg", {0.27}}}},
                        {"buie", "sun", {{"sun_shape", {"buie"}}, {"circumsolar_ratio", {0.3}}}}};
  for (const Case& one : cases) {
    const auto traced = [&](const Vec3& at_m) {
      const Vec3 direction(0.2, -0.1, -1.0);
      const Vec3 lamp_m = turned.point(at_m) - 3.0 * side_m * direction;
      const double radius_m = small_scene(at_m).radius_m();
      return trace_small(at_m, turned,
                         fixtures::source(one.kind, one.keys, lamp_m, direction, radius_m));
    };
    const Traced near = traced(Vec3::Zero()), far = traced(far_at_m);
    ASSERT_GT(near.hits_m.size(), 4000u) << one.name;
    ASSERT_EQ(near.hits_m.size(), far.hits_m.size()) << one.name;
    double worst_m = 0.0;
    for (size_t i = 0; i < near.hits_m.size(); ++i) {
      worst_m = std::max(worst_m, (near.hits_m[i] - far.hits_m[i]).norm());
    }
    EXPECT_LT(worst_m, 1e-6 * side_m) << one.name;
    for (size_t i = 0; i < near.balance.absorbed_by_instance_W.size(); ++i) {
      const double absorbed_W = near.balance.absorbed_by_instance_W[i].value;
      EXPECT_NEAR(far.balance.absorbed_by_instance_W[i].value, absorbed_W, 1e-6 * absorbed_W)
          << one.name << i;
    }
    for (size_t i = 0; i < near.bins_W_m2.size(); ++i) {
      EXPECT_NEAR(far.bins_W_m2[i].value, near.bins_W_m2[i].value, 1e-6 * near.bins_W_m2[i].value)
          << one.name << i;
    }
    Vec3 force_N, torque_N_m, near_N, near_N_m;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto i = static_cast<size_t>(k);
      force_N[k] = far.balance.force_N[i].value;
      torque_N_m[k] = far.balance.torque_N_m[i].value;
      near_N[k] = near.balance.force_N[i].value;
      near_N_m[k] = near.balance.torque_N_m[i].value;
    }
    EXPECT_LT((force_N - near_N).norm(), 1e-6 * near_N.norm()) << one.name;
    const Vec3 lever_N_m = far_at_m.cross(near_N);
    EXPECT_LT((torque_N_m - lever_N_m - near_N_m).norm(), 1e-6 * lever_N_m.norm()) << one.name;
  }
}

// Quadrature for maps of open plates, and for force and torque about the scene's middle with
// shadows, mirrors and scattered light.
TEST(FarScene, DistanceDoesNotChangeQuadrature) {
  const Vec3 far_at_m(far_m, -7e3, 3e3);
  const auto gathered = [](const Vec3& at_m, const Beam& beam) {
    Scene scene;
    add(scene, rectangle(at_m, Vec3(side_m, 0, 0.1 * side_m), Vec3(0, side_m, 0)),
        grey_surface("grey", 0.3, 0.4), "receiver");
    const TraceableScene traceable(scene);
    const FluxMapReceiver map = fixtures::map_of(scene, 8);
    const Gathered direct = gather_direct(traceable, {}, std::span(&beam, 1), map, {});
    std::vector<double> bins_W;
    for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
      double sum_W = 0.0;
      for (int r = 0; r < direct.direct.replicates; ++r) {
        sum_W += direct.direct.of(r)[map.entry(bin, 0)] / direct.direct.replicates;
      }
      bins_W.push_back(sum_W);
    }
    return bins_W;
  };
  const auto lamp = [](const Vec3& at_m) {
    return fixtures::gaussian_led(0.2 * side_m, 2.0, at_m + Vec3(0, 0, 30.0 * side_m),
                                  Vec3(0, 0.01, -1));
  };
  const std::vector<double> near_W = gathered(Vec3::Zero(), lamp(Vec3::Zero()));
  const std::vector<double> far_W = gathered(far_at_m, lamp(far_at_m));
  const double sum_W = std::accumulate(near_W.begin(), near_W.end(), 0.0);
  for (size_t i = 0; i < near_W.size(); ++i) EXPECT_NEAR(far_W[i], near_W[i], 1e-6 * sum_W);

  const auto wrench = [](const Vec3& at_m) {
    const Scene scene = small_scene(at_m);
    const TraceableScene traceable(scene);
    const Beam sun = fixtures::source("sun", {{"irradiance_W_m2", {fixtures::irradiance_W_m2}}},
                                      Vec3::Zero(), Vec3(0.2, -0.1, -1.0), scene.radius_m());
    SunlitEffort effort;
    effort.scattered.rays = 1 << 12;
    effort.mirror_cells = 200;
    return SunlitBody::make(traceable, std::span(&sun, 1), at_m, effort)
        ->wrench({}, INFINITY)
        .total();
  };
  const WrenchSum near = wrench(Vec3::Zero()), far = wrench(far_at_m);
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double scale = near.segment<3>(k < 3 ? 0 : 3).matrix().norm();
    EXPECT_NEAR(far[k], near[k], 1e-6 * scale) << k;
  }
}

}  // namespace
}  // namespace photorque
