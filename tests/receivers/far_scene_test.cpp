// Small parts far from the body's origin: single precision must not see the distance.
#include <gtest/gtest.h>

#include "receivers/gather/bodies/sunlit_body.h"
#include "receivers/gather/bodies/wrench.h"
#include "tests/receivers/sunlight.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::pressure_Pa;
using fixtures::rectangle;

constexpr double far_m = 1e4, side_m = 1e-3;

Scene far_plate() {
  Scene scene;
  add(scene, rectangle(Vec3(far_m, far_m, 0), Vec3(side_m, 0, 0), Vec3(0, side_m, 0)),
      grey_surface("black", 0.0, 0.0), "plate");
  // A wall beside it shades nothing of what comes from straight above.
  add(scene, rectangle(Vec3(far_m - side_m, far_m, 0), Vec3(0, side_m, 0), Vec3(0, 0, side_m)),
      grey_surface("black", 0.0, 0.0), "wall");
  return scene;
}

TEST(FarScene, RaysLandWhereTheyShould) {
  const Scene scene = far_plate();
  const TraceableScene traceable(scene);
  const Beam lamp = fixtures::source("led",
                                     {{"power_W", fixtures::number(1.0)},
                                      {"aperture_diameter_m", fixtures::number(0.4 * side_m)},
                                      {"profile", fixtures::text("pillbox")},
                                      {"half_angle_deg", fixtures::number(0.5)},
                                      {"pillbox_measure", fixtures::text("angle")}},
                                     Vec3(far_m, far_m, 0.1 * side_m));
  Vec3 low = Vec3::Constant(INFINITY), high = -low, sum = Vec3::Zero();
  size_t count = 0;
  TraceOptions options;
  options.rays = 1 << 14;
  options.replicates = 8;
  options.threads = 1;
  options.observe = [&](const HitOrigin&, const Hits& hits) {
    for (int i = 0; i < hits.count; ++i) {
      const Vec3 at(hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]);
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
      sum += at;
      ++count;
    }
  };
  const TraceResult result = trace(traceable, {}, std::span(&lamp, 1), {}, options);
  EXPECT_NEAR(result.power_balance.absorbed_by_instance_W[0].value, 1.0, 1e-12);
  const Vec3 centre(far_m, far_m, 0.0), mean = sum / static_cast<double>(count);
  EXPECT_LT((mean - centre).norm(), 1e-5 * side_m);
  const double radius_m = 0.2 * side_m + 0.1 * side_m * std::tan(0.5 * degree_rad);
  EXPECT_NEAR(high.x() - far_m, radius_m, 1e-2 * radius_m);
  EXPECT_NEAR(low.y() - far_m, -radius_m, 1e-2 * radius_m);
  EXPECT_NEAR(high.z(), 0.0, 1e-12);
}

// p A cos θ along the light, and its torque about the body's origin.
TEST(FarScene, SunlightHasTheTextbookPressure) {
  const Scene scene = far_plate();
  const TraceableScene traceable(scene);
  const Beam sun = fixtures::sun(0.0);
  const auto body = SunlitBody::make(traceable, std::span(&sun, 1), Vec3::Zero());
  const WrenchSum found = body->wrench({}, INFINITY).total();
  const double force_N = pressure_Pa * side_m * side_m;
  EXPECT_NEAR(found[2], -force_N, 1e-6 * force_N);
  EXPECT_NEAR(found[3], -far_m * force_N, 1e-6 * far_m * force_N);
  EXPECT_NEAR(found[4], far_m * force_N, 1e-6 * far_m * force_N);
}

}  // namespace
}  // namespace photorque
