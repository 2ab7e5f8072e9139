#include "receivers/torque_map.h"

#include "raytrace/tracing/tracer.h"
#include "receiver_scenes.h"
#include "receivers/wrench/wrench.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque {
namespace {

using fixtures::HitMaker;
using fixtures::map_named;
using fixtures::plate;
using fixtures::quantity_named;
using fixtures::scene_of;
using fixtures::sums_of;

constexpr uint32_t plate_instance[] = {0};

TorqueMapReceiver receiver_on(const Scene& scene, int bins, const Vec3& about_m = Vec3::Zero()) {
  SurfaceGridOptions options;
  options.width = options.height = bins;
  options.side = Side::both;
  return {"plate", scene, make_surface_grid(scene, plate_instance, options), about_m};
}

// Light along (sin 30°, 0, −cos 30°) with a pressure of 1 Pa on its cross-section, absorbed by the
// square |x|, |y| ≤ 1/2 at height z: cos 30° N in all, in n × n equal shares.
std::vector<HitMaker> even_light(int n, double z) {
  const double tilt = 30 * degree_rad;
  const Vec3 direction(std::sin(tilt), 0, -std::cos(tilt));
  std::vector<HitMaker> hits;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      HitMaker hit;
      hit.position_m = {(i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5, z};
      hit.force_N = direction * std::cos(tilt) / (n * n);
      hits.push_back(hit);
    }
  }
  return hits;
}

// Equation 29 of the paper, with the cosine that the power on the plate holds already: in parallel
// light a black plate feels cos θ of what momentum says, and a mirror the same as a black one.
TEST(TorqueMap, AsPublishedTakesTheCosineOnceMoreAndAbsorbsAll) {
  for (const double tilt_deg : {0.0, 30.0, 55.0}) {
    for (const double mirrored : {0.0, 0.4}) {
      Scene scene = scene_of(plate(-0.4, 0.3, -0.2, 0.5, 0.1));
      scene.surfaces = {grey_surface("s", mirrored, 0.0)};
      SurfaceGridOptions options;
      options.side = Side::both;
      const SurfaceGrid grid = make_surface_grid(scene, plate_instance, options);
      using Force = TorqueMapReceiver::Force;
      const TorqueMapReceiver own("own", scene, grid, Vec3::Zero(), Force::momentum);
      const TorqueMapReceiver printed("printed", scene, grid, Vec3::Zero(), Force::as_published);
      const Beam sun =
          fixtures::source("sun", {{"irradiance_W_m2", {1000.0}}, {"angular_radius_deg", {0.0}}});
      const TraceableScene traceable(scene);
      const Receiver* const receivers[] = {&own, &printed};
      const RigidTransform attitude = lab_from_body_at(tilt_deg * degree_rad, 0.3);
      TraceOptions few;
      few.rays = 1 << 14;
      const TraceResult traced = trace(traceable, attitude, std::span(&sun, 1), receivers, few);
      const TorqueMap expected = own.torque_map(traced.sums[0]);
      const TorqueMap found = printed.torque_map(traced.sums[1]);
      // A mirror turns d into d − 2 (d·n) n: of the torque of light absorbed it leaves the part
      // 1 − s across and 1 + s along the normal; the part along the plate is about z.
      const double scale_N_m = 1000.0 * 0.49 * 0.3 / speed_of_light_m_s;
      const double cosine = std::cos(tilt_deg * degree_rad);
      const double z_N_m = expected.total_N_m[2].value / (1.0 - mirrored);
      EXPECT_NEAR(found.total_N_m[2].value, cosine * z_N_m, 1e-6 * scale_N_m);
      if (mirrored > 0.0) continue;
      for (size_t axis = 0; axis < 2; ++axis) {
        const double whole_N_m = expected.total_N_m[axis].value;
        EXPECT_NEAR(found.total_N_m[axis].value, cosine * whole_N_m, 1e-6 * scale_N_m);
      }
    }
  }
}

TEST(TorqueMap, EvenLightOnAPlateAboveThePivot) {
  // T = z·e_z × F in total: z cos 30° sin 30° about y, nothing about x and z.
  const double z = 0.2, fraction = std::cos(30 * degree_rad) * std::sin(30 * degree_rad);
  const Scene scene = scene_of(plate(-0.5, 0.5, -0.5, 0.5, z));
  const TorqueMapReceiver receiver = receiver_on(scene, 20);
  const auto hits = even_light(20, z);
  const TorqueMap map = receiver.torque_map(sums_of(receiver, {hits, hits}));
  EXPECT_NEAR(map.total_N_m[0].value, 0.0, 1e-15);
  EXPECT_NEAR(map.total_N_m[1].value, z * fraction, 1e-15);
  EXPECT_NEAR(map.total_N_m[2].value, 0.0, 1e-15);
  // About y a bin at x adds z F_x − x F_z = (z sin 30° + x cos 30°) cos 30° / n², a plane in x that
  // is the same for every y.
  for (int i = 0; i < 20; ++i) {
    const double x = (i + 0.5) / 20 - 0.5;
    const double expected =
        (z * 0.5 + x * std::cos(30 * degree_rad)) * std::cos(30 * degree_rad) / 400;
    for (int j = 0; j < 20; ++j) {
      EXPECT_NEAR(map.per_bin_N_m[1][static_cast<size_t>(20 * j + i)].value, expected, 1e-17);
    }
  }
}

TEST(TorqueMap, BinsSumToTheWrenchAboutTheSamePoint) {
  const Scene scene = scene_of(plate(-0.5, 0.5, -0.5, 0.5, 0.3));
  const Vec3 about_m(0.1, -0.2, 0.05);
  const TorqueMapReceiver receiver = receiver_on(scene, 7, about_m);
  const WrenchReceiver wrench("w", scene, {0}, about_m);
  std::vector<std::vector<HitMaker>> replicates;
  for (const int n : {9, 14, 30}) replicates.push_back(even_light(n, 0.3));
  replicates[0][3].front = false;  // light on the back pushes as well
  const TorqueMap map = receiver.torque_map(sums_of(receiver, replicates));
  const WrenchEstimate expected = wrench.total(sums_of(wrench, replicates));
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    // Added in another order: up to 900 numbers below 1, each sum rounded by 1e-16 at most.
    EXPECT_NEAR(map.total_N_m[axis].value, expected.mean.torque_N_m[k], 1e-14);
    EXPECT_NEAR(map.total_N_m[axis].standard_error, expected.torque_error_N_m()[k], 1e-14);
    double sum = 0.0;
    for (const Estimate& bin : map.per_bin_N_m[axis]) sum += bin.value;
    EXPECT_NEAR(sum, expected.mean.torque_N_m[k], 1e-14);
  }
}

TEST(TorqueMap, ErrorOfABinByHand) {
  // 1, 2 and 6 N along x at z = 1 m in three replicates: 3 ± √(7/3) N m about y.
  const Scene scene = scene_of(plate(0, 1, 0, 1, 1.0));
  const TorqueMapReceiver receiver = receiver_on(scene, 1);
  std::vector<std::vector<HitMaker>> replicates;
  for (const double force_N : {1.0, 2.0, 6.0}) {
    HitMaker hit;
    hit.position_m = {0, 0, 1};
    hit.force_N = {force_N, 0, 0};
    replicates.push_back({hit});
  }
  const Product product = receiver.product(sums_of(receiver, replicates));
  const Map& map = map_named(product, "torque_y_plate");
  EXPECT_NEAR(map.value[0], 3.0, 1e-14);
  EXPECT_NEAR(map.standard_error[0], std::sqrt(7.0 / 3.0), 1e-14);
  EXPECT_TRUE(map.signed_values);
  EXPECT_EQ(map.unit, "N m");
  EXPECT_NEAR(quantity_named(product, "torque_y_plate_body_N_m").value, 3.0, 1e-14);
}

}  // namespace
}  // namespace photorque
