// Direct light gathered from the surface's side.
#include "receivers/gather/gather.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "tests/outside.h"
#include "tests/raytrace/test_scenes.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::box;
using fixtures::gaussian_led;
using fixtures::map_of;
using fixtures::pillbox_disc;
using fixtures::rectangle;
using fixtures::shaded_square;
using fixtures::source;

Estimate direct(const Gathered& gathered, const FluxMapReceiver& map, size_t bin) {
  std::vector<double> values;
  for (int r = 0; r < gathered.direct.replicates; ++r) {
    values.push_back(gathered.direct.of(r)[map.entry(bin, 0)]);
  }
  return estimate_from_replicates(values);
}

class GatheredDisc : public ::testing::TestWithParam<std::tuple<const char*, const char*, double>> {
};

// The reference maps of case A; precise to 1e-4 (A0) and 7e-4 (A1).
TEST_P(GatheredDisc, MapAgreesWithTheReference) {
  const auto& [name, measure, precision] = GetParam();
  const auto reference = outside::read_float32(outside::reference_data("optics") / name);
  ASSERT_EQ(reference.size(), 10000u);
  const double peak = *std::max_element(reference.begin(), reference.end());

  const TraceableScene scene(shaded_square());
  const FluxMapReceiver map = map_of(scene.scene(), 100);
  const Beam beam = pillbox_disc(measure);
  GatherOptions options;
  options.points = 64;
  const Gathered gathered = gather_direct(scene, {}, std::span(&beam, 1), map, options);
  EXPECT_GT(gathered.shaded_pairs, 500u);
  EXPECT_GT(gathered.open_pairs, 5000u);
  double squares = 0.0, rms = 0.0;
  int shaded = 0, lit = 0;
  for (size_t bin = 0; bin < reference.size(); ++bin) {
    if (reference[bin] < 0.1 * peak) continue;
    const Estimate e = direct(gathered, map, bin);
    const double area_m2 = map.grid().area_m2[bin];
    const double difference = e.value / area_m2 - reference[bin];
    ++lit;
    rms += std::pow(difference / reference[bin], 2);
    if (e.standard_error < 1e-9 * e.value) {
      // A reference from rays is noisier where there is less light.
      const double noise = precision * std::sqrt(peak / reference[bin]);
      EXPECT_NEAR(difference / reference[bin], 0.0, 6 * noise + 1e-3) << bin;
    } else {
      ++shaded;
      squares += std::pow(difference, 2) / (std::pow(e.standard_error / area_m2, 2) +
                                            std::pow(precision * reference[bin], 2));
    }
  }
  rms = std::sqrt(rms / lit);
  EXPECT_LT(rms, 0.005);
  // F(1, 15) has mean 15/13 = 1.154 and a long tail.
  EXPECT_NEAR(squares / shaded, 1.154, 0.25);
}
INSTANTIATE_TEST_SUITE_P(CaseA, GatheredDisc,
                         ::testing::Values(std::tuple{"disc_angle.f32", "angle", 1e-4},
                                           std::tuple{"disc_projected.f32", "projected", 7e-4}));

// Rays and gather are two routes to one map, also at an angle, with several lamps and over a
// surface with a hole.
TEST(Gather, AgreesWithRaysWithinTheErrorsOfBoth) {
  Scene scene;
  const auto grey = grey_surface("grey", 0.1, 0.3);
  // A frame: four rectangles about a hole that cuts through bins.
  for (const auto& [x, y, w, h] : {std::array{-0.17, 0.0, 0.16, 0.5},
                                   {0.17, 0.0, 0.16, 0.5},
                                   {0.0, 0.17, 0.18, 0.16},
                                   {0.0, -0.17, 0.18, 0.16}}) {
    add(scene, rectangle(Vec3(x, y, 0), Vec3(w, 0, 0), Vec3(0, h, 0)), grey, "receiver");
  }
  add(scene, box(Vec3(0.1, 0.1, 0), Vec3(0.12, 0.14, 0.1)), grey, "post");
  add(scene, box(Vec3(-0.15, -0.2, 0.2), Vec3(-0.12, 0.1, 0.22)), grey, "bar");
  const TraceableScene traceable(scene);
  const FluxMapReceiver map = map_of(traceable.scene(), 23);
  const std::vector<Beam> beams = {
      gaussian_led(0.05, 9.0, {0.3, 0, 1.4}, {-0.2, 0, -1}),
      gaussian_led(0.005, 14.0, {-0.2, 0.1, 1.0}, {0.2, -0.1, -1}),
      source("led",
             {{"power_W", {1.0}},
              {"aperture_diameter_m", {0.3}},
              {"profile", {"pillbox"}},
              {"half_angle_deg", {4.0}},
              {"pillbox_measure", {"solid_angle"}},
              {"halo_fraction", {0.2}},
              {"halo_fwhm_deg", {12.0}}},
             {0, 0.05, 1.2}, {0, 0, -1}),
      source("sun", {{"irradiance_W_m2", {10.0}}, {"angular_radius_deg", {2.0}}}, {},
             {0.2, 0.3, -1})};
  const RigidTransform lab_from_body = lab_from_body_at(20 * degree_rad, 0.4);
  const Gathered gathered = gather_direct(traceable, lab_from_body, beams, map, {});
  const Receiver* const receivers[] = {&map};
  const TraceResult traced = trace(traceable, lab_from_body, beams, receivers, {.rays = 1 << 23});

  double squares = 0.0, total = 0.0, rays_total = 0.0, variance = 0.0;
  int compared = 0;
  for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
    const Estimate g = direct(gathered, map, bin), r = traced.sums[0].estimate(map.entry(bin, 0));
    const double error = std::hypot(g.standard_error, r.standard_error);
    total += g.value;
    rays_total += r.value;
    variance += error * error;
    if (g.value < 1e-6) {
      EXPECT_LT(r.value, 1e-5) << bin;
      continue;
    }
    ++compared;
    squares += std::pow((g.value - r.value) / error, 2);
  }
  EXPECT_GT(compared, 300);
  EXPECT_NEAR(squares / compared, 1.1, 0.25);
  EXPECT_NEAR(total, rays_total, 4 * std::sqrt(variance));
  EXPECT_GT(gathered.shaded_pairs, 100u);
  EXPECT_GT(gathered.open_pairs, 500u);
}

TEST(Gather, SunOnAPlateIsCosineOfItsAngle) {
  Scene scene;
  add(scene, rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0)), grey_surface("s", 0, 0.25),
      "receiver");
  const TraceableScene traceable(scene);
  for (const int side : {8, 33}) {  // 33: tiles of 16 bins leave some that are one bin wide
    const FluxMapReceiver map = map_of(traceable.scene(), side);
    for (const double radius_deg : {0.0, 0.2665, 5.0}) {
      const Beam sun =
          source("sun", {{"irradiance_W_m2", {1361.0}}, {"angular_radius_deg", {radius_deg}}});
      const Gathered g = gather_direct(traceable, lab_from_body_at(60 * degree_rad, 0.0),
                                       std::span(&sun, 1), map, {});
      EXPECT_EQ(g.shadow_rays, 0u);
      const auto bins = static_cast<size_t>(side * side);
      for (const size_t bin : {size_t{0}, bins / 2, bins - 2, bins - 1}) {
        const double power_W = 1361 * 0.5 / static_cast<double>(bins);
        EXPECT_NEAR(g.direct.of(0)[map.entry(bin, 0)], power_W, 1e-6 * power_W) << radius_deg;
        EXPECT_NEAR(g.direct.of(0)[map.entry(bin, 0) + 1], 0.75 * power_W, 1e-6 * power_W);
      }
    }
  }
}

TEST(Gather, GoesOnUntilTheErrorIsReached) {
  const TraceableScene scene(shaded_square());
  const FluxMapReceiver map = map_of(scene.scene(), 20);
  const Beam beam = pillbox_disc("projected");
  GatherOptions once;
  once.points = 4;
  const Gathered coarse = gather_direct(scene, {}, std::span(&beam, 1), map, once);
  GatherOptions aimed = once;
  aimed.target_error = 0.01;
  const Gathered fine = gather_direct(scene, {}, std::span(&beam, 1), map, aimed);
  EXPECT_GT(coarse.worst_error, 0.01);
  EXPECT_LE(fine.worst_error, 0.01);
  EXPECT_GT(fine.shadow_rays, 2 * coarse.shadow_rays);
}

TEST(Gather, FeaturesThatNeedRaysAreRejected) {
  Scene scene;
  add(scene, fixtures::sphere(0.1, 8), grey_surface("s", 0, 0), "receiver");
  SurfaceGridOptions options;
  options.facing_body = Vec3::UnitZ();
  const FluxMapReceiver map("receiver", scene, make_surface_grid(scene, {{0}}, options));
  const TraceableScene traceable(scene);
  const Beam beam = pillbox_disc("angle");
  EXPECT_THROW(gather_direct(traceable, {}, std::span(&beam, 1), map, {}), InputError);
}

// A map of 10,000 bins and 8.4 million rays: docs/benchmarks.md.
TEST(GatheringPays, ForHundredsOfLampsButNotForThousands) {
  constexpr size_t bins = 10000;
  constexpr uint64_t rays = 1ull << 23;
  EXPECT_TRUE(gathering_pays(bins * 49, rays));
  EXPECT_TRUE(gathering_pays(bins * 500, rays));
  EXPECT_FALSE(gathering_pays(bins * 5000, rays));
  EXPECT_TRUE(gathering_pays(bins * 5000, 64 * rays));
  EXPECT_TRUE(gathering_pays(bins * 49, 1024));  // half a second whatever the rays take
}

}  // namespace
}  // namespace photorque
