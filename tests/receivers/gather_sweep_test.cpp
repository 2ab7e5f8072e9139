// Gathered light keeps its stated error for any profile, aperture, distance, tilt and bins.
#include <gtest/gtest.h>

#include "raytrace/direct/disc_light.h"
#include "receivers/gather/gather.h"
#include "tests/receivers/random_lamps.h"

namespace photorque {
namespace {

using fixtures::Draw;
using fixtures::RandomLamps;

struct Total {
  double power_W = 0.0, bound_W = 0.0;
};

Total total_of(const Gathered& gathered, const FluxMapReceiver& map) {
  Total total;
  for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
    total.power_W += gathered.direct.of(0)[map.entry(bin, 0)];
    total.bound_W += gathered.direct.bound_of(map.entry(bin, 0));
  }
  return total;
}

FluxMapReceiver map_over(const Scene& scene, int width, int height) {
  SurfaceGridOptions options;
  options.width = width;
  options.height = height;
  return {"receiver", scene, make_surface_grid(scene, scene.instances_of("receiver"), options)};
}

// All light of a lamp falls on a plate that is wide enough, however coarse its bins.
TEST(GatherSweep, AWidePlateGetsAllLightOfAThousandLamps) {
  RandomLamps random_lamps(15);
  for (int i = 0; i < 1000; ++i) {
    const Draw d = random_lamps.draw();
    const auto scene = fixtures::wide_plate(d, random_lamps.uniform(1.0, 1.5));
    if (!scene) continue;
    const TraceableScene traceable(*scene);
    const FluxMapReceiver map =
        map_over(*scene, random_lamps.integer(1, 50), random_lamps.integer(1, 50));
    const Gathered gathered = gather_direct(traceable, {}, std::span(&d.beam, 1), map,
                                            {.replicates = 2, .points = 1, .threads = 1});
    EXPECT_EQ(gathered.shaded_pairs, 0u);
    const Total total = total_of(gathered, map);
    EXPECT_LT(total.bound_W, 1e-5) << i << ": " << d.description;
    EXPECT_NEAR(total.power_W, 1.0, 5e-9 + total.bound_W) << i << ": " << d.description;
  }
}

// ∫∫ over a rectangle of the irradiance at its points, one integral within another.
double nested_power_W(const DiscLight& light, const Vec3& corner_m, const Vec3& along_m,
                      const Vec3& across_m, double tolerance) {
  const Vec3 normal = along_m.cross(across_m).normalized();
  const double typical = light.typical_W_m2(corner_m.z());
  const auto row = [&](double t) {
    const auto at = [&](double s) {
      return light.irradiance_W_m2(corner_m + s * along_m + t * across_m, normal);
    };
    return integrate_adaptively(at, 0.0, 1.0, 0.1 * tolerance * typical, 16).value;
  };
  const double mean = integrate_adaptively(row, 0.0, 1.0, tolerance * typical, 16).value;
  return mean * along_m.cross(across_m).norm();
}

TEST(GatherSweep, BinsCutByAnEdgeAgreeWithNestedIntegration) {
  RandomLamps random_lamps(16);
  for (int i = 0; i < 150; ++i) {
    const Draw d = random_lamps.draw();
    const DiscLight light(*d.beam.emitter, *d.beam.aperture);
    // A bin about the rim of the light at half of the flux.
    const double radius_m =
        std::hypot(light.radius_m(), d.height_m * std::tan(light.half_flux_rad()));
    const double side_m = radius_m * random_lamps.log_uniform(0.02, 1.0);
    Draw moved = d;
    moved.centre_m += random_lamps.uniform(0.0, 1.3) * radius_m * d.along;
    const Scene scene = fixtures::plate_of(moved, side_m, side_m);
    const TraceableScene traceable(scene);
    const FluxMapReceiver map = map_over(scene, 1, 1);
    const Gathered gathered = gather_direct(traceable, {}, std::span(&d.beam, 1), map,
                                            {.replicates = 2, .points = 1, .threads = 1});
    if (gathered.shaded_pairs > 0) continue;
    const Total total = total_of(gathered, map);
    const Vec3 corner_m = moved.centre_m - 0.5 * side_m * (d.along + d.across);
    const double expected =
        nested_power_W(light, corner_m, side_m * d.along, side_m * d.across, 1e-7);
    const double scale = std::min(1.0, side_m * side_m * light.typical_W_m2(d.height_m));
    EXPECT_NEAR(total.power_W, expected, total.bound_W + 5e-6 * scale)
        << i << ": " << d.description;
    EXPECT_LT(total.bound_W, 1e-5 * std::max(scale, expected)) << i << ": " << d.description;
  }
}

// The mean irradiance within a circle, which the flux within angles gives, is that of its points,
// which the intensity gives.
TEST(GatherSweep, MeanWithinACircleIsThatOfItsPoints) {
  RandomLamps random_lamps(17);
  for (int i = 0; i < 200; ++i) {
    const Draw d = random_lamps.draw();
    const DiscLight light(*d.beam.emitter, *d.beam.aperture);
    const double within_m = random_lamps.uniform(0.0, 1.2) * d.foot_m;
    const double typical = light.typical_W_m2(d.height_m);
    std::vector<double> kinks_m = {0.0, within_m};
    for (const double slope : light.angles().edge_slopes()) {
      for (const double side : {-slope, slope}) {
        const double kink_m = std::abs(light.radius_m() + side * d.height_m);
        if (kink_m < within_m) kinks_m.push_back(kink_m);
      }
    }
    std::sort(kinks_m.begin(), kinks_m.end());
    const auto ring = [&](double r) {
      return 2.0 * r * light.irradiance_W_m2({r, 0.0, d.height_m}, -Vec3::UnitZ());
    };
    double sum = 0.0;
    for (size_t k = 1; k < kinks_m.size(); ++k) {
      const double tolerance = 1e-8 * typical * within_m * within_m;
      sum += integrate_adaptively(ring, kinks_m[k - 1], kinks_m[k], tolerance).value;
    }
    const auto mean = light.mean_within_W_m2(within_m, d.height_m, 1e-8 * typical);
    EXPECT_NEAR(mean.value, sum / (within_m * within_m), 2e-7 * typical)
        << i << ": " << d.description;
  }
}

}  // namespace
}  // namespace photorque
