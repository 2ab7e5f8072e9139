// The rays that `trace` saves for other optics programs.
#include "core/files.h"
#include "sources/photometry/ray_set.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;

class ArrivingRaysCommand : public CommandTest {};

// 90.15 % of 88 W reach the array (docs/validation.md).
TEST_F(ArrivingRaysCommand, CarryThePowerOnTheSurface) {
  const Outcome done =
      succeed("trace " + nominal_file +
              " --set trace.rays=65536 --set trace.arriving_rays=100000 --out " + at("o"));
  EXPECT_THAT(done.out, HasSubstr("rays_solar_array.tm25ray"));
  const RaySet rays = read_tm25(read_file(at("o/rays_solar_array.tm25ray")), "rays");
  EXPECT_GT(rays.rays.size(), 80'000u);
  EXPECT_NEAR(rays.ray_flux(), 0.9015 * 88.0, 0.005 * 88.0);
  EXPECT_NEAR(rays.stated_radiant_flux_W.value(), rays.ray_flux(), 1e-4);
  double min_m = 1.0, max_m = -1.0;
  for (const RaySet::Ray& ray : rays.rays) {
    EXPECT_NEAR(ray.direction.norm(), 1.0, 1e-6);
    EXPECT_LT(ray.direction.z(), -0.9);
    EXPECT_NEAR(ray.wavelength_m, 730e-9, 1e-13);
    min_m = std::min(min_m, ray.origin_m.z());
    max_m = std::max(max_m, ray.origin_m.z());
  }
  EXPECT_LT(max_m - min_m, 1e-6);  // a flat array
}

}  // namespace
}  // namespace photorque
