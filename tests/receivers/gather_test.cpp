// Direct light gathered from the surface's side.
#include "receivers/gather.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/constants.h"
#include "raytrace/chebyshev.h"
#include "raytrace/disc_light.h"
#include "raytrace/gauss_legendre.h"
#include "raytrace/irradiance_table.h"
#include "raytrace/shadow.h"
#include "sources/source_kind.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

using testing::add;
using testing::box;
using testing::rectangle;

SettingsNode number(double x) {
  return {x, {}};
}
SettingsNode text(const char* t) {
  return {std::string(t), {}};
}
SettingsNode vector(const Vec3& v) {
  return {SettingsNode::Array{number(v.x()), number(v.y()), number(v.z())}, {}};
}

// One source of the given kind at `at_m`, looking along `direction`.
Beam source(const char* which, SettingsNode::Table keys, const Vec3& at_m = {0, 0, 1.5},
            const Vec3& direction = {0, 0, -1}) {
  keys["direction"] = vector(direction);
  if (std::string(which) == "led") {
    keys["position_m"] = vector(at_m);
    keys["wavelength_nm"] = number(730);
  }
  const Settings settings(std::make_shared<const SettingsNode>(SettingsNode{std::move(keys), {}}));
  for (const SourceKind& kind : all_source_kinds()) {
    if (kind.name == which) return kind.make(settings, {.scene_radius_m = 1.0, .notice = {}})[0];
  }
  throw std::logic_error("no such source");
}

Beam lambertian_disc(double diameter_m) {
  return source("led", {{"power_W", number(2.0)},
                        {"aperture_diameter_m", number(diameter_m)},
                        {"profile", text("cosine_power")},
                        {"exponent", number(1.0)}});
}

Beam gaussian_led(double diameter_m, double fwhm_deg, const Vec3& at_m, const Vec3& direction) {
  return source("led",
                {{"power_W", number(1.0)},
                 {"aperture_diameter_m", number(diameter_m)},
                 {"profile", text("gaussian")},
                 {"fwhm_deg", number(fwhm_deg)}},
                at_m, direction);
}

Beam pillbox_disc(const char* measure) {
  return source("led", {{"power_W", number(1.0)},
                        {"aperture_diameter_m", number(0.4)},
                        {"profile", text("pillbox")},
                        {"half_angle_deg", number(1.5)},
                        {"pillbox_measure", text(measure)}});
}

// View factors from a surface element to a disc of radius r, by contour integration.
// Source: J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-12 (element
// parallel to the disc, offset a) and B-15 (element normal to the disc's plane, facing its axis).
double parallel_view_factor(double h, double a, double r) {
  const double H = h / a, R = r / a, Z = 1 + H * H + R * R;
  return 0.5 * (1 - (Z - 2 * R * R) / std::sqrt(Z * Z - 4 * R * R));
}
double upright_view_factor(double h, double a, double r) {
  const double H = h / a, R = r / a, Z = 1 + H * H + R * R;
  return 0.5 * H * (Z / std::sqrt(Z * Z - 4 * R * R) - 1);
}

TEST(DiscLight, LambertianDiscMatchesViewFactors) {
  const double r = 0.2, exitance = 2.0 / (pi * r * r);
  const Beam beam = lambertian_disc(2 * r);
  const DiscLight light(*beam.emitter, *beam.aperture);
  EXPECT_NEAR(light.exitance_W_m2(), exitance, 1e-12 * exitance);
  for (const double h : {0.05, 0.3, 2.0}) {
    EXPECT_NEAR(light.irradiance_W_m2({0, 0, h}, {0, 0, -1}), exitance * r * r / (h * h + r * r),
                1e-5 * exitance);
    for (const double a : {0.1, 0.2, 0.5, 1.5}) {
      const double parallel = exitance * parallel_view_factor(h, a, r);
      EXPECT_NEAR(light.irradiance_W_m2({a, 0, h}, {0, 0, -1}), parallel, 2e-5 * exitance)
          << h << " " << a;
    }
    // An upright element sees the whole disc from the front only beside it.
    for (const double a : {0.5, 1.5}) {
      const double upright = exitance * upright_view_factor(h, a, r);
      EXPECT_NEAR(light.irradiance_W_m2({0, a, h}, {0, -1, 0}), upright, 2e-5 * exitance)
          << h << " " << a;
    }
  }
}

TEST(DiscLight, LightOnAWidePlaneIsAllItsPower) {
  for (const double diameter_m : {0.002, 0.02, 0.2}) {
    const Beam beam = gaussian_led(diameter_m, 6.0, {0, 0, 0}, {0, 0, 1});
    const DiscLight light(*beam.emitter, *beam.aperture);
    const double h = 1.0;
    double power_W = 0.0;
    for (const auto& [x, weight] : gauss_legendre(64)) {
      const double r = 0.35 * (1 + x);
      power_W += 0.35 * weight * 2 * pi * r * light.irradiance_W_m2({r, 0, h}, {0, 0, -1});
    }
    EXPECT_NEAR(power_W, 1.0, 3e-5) << diameter_m;
  }
}

TEST(DiscLight, HalfOfTheFluxOfAGaussianIsWithinHalfItsWidth) {
  const Beam beam = gaussian_led(0.01, 3.0, {0, 0, 0}, {0, 0, 1});
  const DiscLight light(*beam.emitter, *beam.aperture);
  EXPECT_NEAR(light.half_flux_rad() / degree_rad, 1.5, 1e-3);
  EXPECT_TRUE(light.fades_out());
  const Beam sharp = pillbox_disc("angle");
  EXPECT_FALSE(DiscLight(*sharp.emitter, *sharp.aperture).fades_out());
}

// Largest difference at scattered points, over the largest irradiance.
double table_error(const DiscLight& light, const IrradianceTable& table, double low_m,
                   double high_m, double wide_m) {
  const SobolSequence points({3, 1, 0});
  double largest = 0.0, worst = 0.0;
  for (uint32_t i = 0; i < 2000; ++i) {
    const auto p = points.point(i);
    const Vec3 at(wide_m * (2 * p[0] - 1), wide_m * (2 * p[1] - 1),
                  low_m + p[2] * (high_m - low_m));
    const double lean = p[3] - 0.5;
    const Vec3 normal(std::sin(lean), 0, -std::cos(lean));
    const double expected = light.irradiance_W_m2(at, normal);
    largest = std::max(largest, expected);
    worst = std::max(worst, std::abs(table.irradiance_W_m2(at, normal) - expected));
  }
  return worst / largest;
}

TEST(IrradianceTable, AgreesWithTheIntegralForSmoothAndForSharpBeams) {
  for (const Beam& beam :
       {gaussian_led(0.045, 3, {0, 0, 1.5}, {0, 0, -1}), pillbox_disc("angle")}) {
    const DiscLight light(*beam.emitter, *beam.aperture);
    for (const double high_m : {1.2, 1.8}) {
      const auto table = IrradianceTable::make(light, 1.2, high_m, 1);
      ASSERT_TRUE(table.has_value()) << high_m;
      EXPECT_LT(table_error(light, *table, 1.2, high_m, 0.3), 5e-6) << high_m;
    }
  }
}

TEST(IrradianceTable, RefusesWhatItCannotTabulate) {
  const Beam pillbox = pillbox_disc("angle"), lambertian = lambertian_disc(0.4);
  const DiscLight sharp(*pillbox.emitter, *pillbox.aperture);
  // The beam's edge crosses the axis at 0.2 m / tan 1.5° = 7.6 m.
  EXPECT_TRUE(IrradianceTable::make(sharp, 6.0, 7.0, 1).has_value());
  EXPECT_FALSE(IrradianceTable::make(sharp, 6.0, 9.0, 1).has_value());
  const DiscLight wide(*lambertian.emitter, *lambertian.aperture);
  EXPECT_FALSE(IrradianceTable::make(wide, 1.0, 2.0, 1).has_value());
}

TEST(Chebyshev, CellMeansOfAPolynomialAreExact) {
  const size_t n = 6, cells = 5;
  const auto f = [](double x) { return 1 - 3 * x + 2 * x * x * x - 7 * std::pow(x, 5); };
  const auto whole = [](double x) {
    return x - 1.5 * x * x + 0.5 * std::pow(x, 4) - 7.0 / 6.0 * std::pow(x, 6);
  };
  Eigen::VectorXd values(static_cast<Eigen::Index>(n));
  for (size_t i = 0; i < n; ++i) values(static_cast<Eigen::Index>(i)) = f(chebyshev_fraction(n, i));
  const Eigen::VectorXd means = chebyshev_cell_means(n, cells) * values;
  for (size_t c = 0; c < cells; ++c) {
    const double low = static_cast<double>(c) / cells, high = static_cast<double>(c + 1) / cells;
    EXPECT_NEAR(means(static_cast<Eigen::Index>(c)), (whole(high) - whole(low)) / (high - low),
                1e-13);
  }
}

TEST(GaussLegendre, RulesIntegratePowersUpToTheirDegree) {
  for (const size_t n : {1u, 2u, 7u, 33u, 64u}) {
    for (const size_t power : {size_t{0}, n, 2 * n - 1, 2 * n - 2}) {
      double sum = 0.0;
      for (const auto& [x, weight] : gauss_legendre(n))
        sum += weight * std::pow(x, static_cast<double>(power));
      const double exact = power % 2 == 1 ? 0.0 : 2.0 / static_cast<double>(power + 1);
      EXPECT_NEAR(sum, exact, 2e-14) << n << " " << power;
    }
  }
}

// A segment between random points of two balls that crosses a triangle proves that the shaft meets
// it.
TEST(Shaft, NeverLosesATriangleThatALineCrosses) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto point = [&](double scale) {
    return Vec3(scale * normal(random), scale * normal(random), scale * normal(random));
  };
  int crossed = 0, spared = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ball from{point(1.0), 0.3 * std::abs(normal(random))};
    const Ball to{point(1.0), 0.3 * std::abs(normal(random))};
    const Vec3 a = from.centre_m + from.radius_m * std::cbrt(0.9) * point(1.0).normalized();
    const Vec3 b = to.centre_m + to.radius_m * std::cbrt(0.9) * point(1.0).normalized();
    // A triangle about a point of the segment, and one anywhere.
    const Vec3 on = a + std::uniform_real_distribution<double>(0, 1)(random) * (b - a);
    const Vec3 e = point(0.5), f = point(0.5);
    const TriangleCorners hit = {on + e, on + f, on - e - f};
    EXPECT_TRUE(Shaft(from, to).may_meet(hit));
    ++crossed;
    const Vec3 away = point(2.0);
    spared += Shaft(from, to).may_meet({away, away + point(0.2), away + point(0.2)}) ? 0 : 1;
  }
  EXPECT_EQ(crossed, 20000);
  EXPECT_GT(spared, 12000);  // it does leave out most of what is far away
}

Scene shaded_square() {
  Scene scene;
  const auto black = grey_surface("black", 0.1, 0.2);
  add(scene, rectangle(Vec3::Zero(), Vec3(0.5, 0, 0), Vec3(0, 0.5, 0)), black, "receiver");
  add(scene, box(Vec3(0, -0.02, 0.5), Vec3(0.1, 0.08, 0.55)), black, "box");
  return scene;
}

FluxMapReceiver map_of(const Scene& scene, int bins) {
  SurfaceGridOptions options;
  options.width = options.height = bins;
  return {"receiver", scene, make_surface_grid(scene, scene.instances_of("receiver"), options)};
}

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
  const auto path =
      std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "../shared/reference/optics" / name;
  std::ifstream in(path, std::ios::binary);
  if (!in) GTEST_SKIP() << "no reference map " << name;
  std::vector<double> reference(10000);
  in.read(reinterpret_cast<char*>(reference.data()), 80000);
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
                         ::testing::Values(std::tuple{"refA0.f64", "angle", 1e-4},
                                           std::tuple{"refA1.f64", "projected", 7e-4}));

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
             {{"power_W", number(1.0)},
              {"aperture_diameter_m", number(0.3)},
              {"profile", text("pillbox")},
              {"half_angle_deg", number(4)},
              {"pillbox_measure", text("solid_angle")},
              {"halo_fraction", number(0.2)},
              {"halo_fwhm_deg", number(12)}},
             {0, 0.05, 1.2}, {0, 0, -1}),
      source("sun", {{"irradiance_W_m2", number(10)}, {"angular_radius_deg", number(2)}}, {},
             {0.2, 0.3, -1})};
  const RigidTransform lab_from_body = lab_from_body_at(20 * degree_rad, 0.4);
  const Gathered gathered = gather_direct(traceable, lab_from_body, beams, map, {});
  const Receiver* const receivers[] = {&map};
  TraceOptions options;
  options.rays = 1 << 23;
  const TraceResult traced = trace(traceable, lab_from_body, beams, receivers, options);

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
  const FluxMapReceiver map = map_of(traceable.scene(), 8);
  for (const double radius_deg : {0.0, 0.2665, 5.0}) {
    const Beam sun = source(
        "sun", {{"irradiance_W_m2", number(1361)}, {"angular_radius_deg", number(radius_deg)}});
    const Gathered g = gather_direct(traceable, lab_from_body_at(60 * degree_rad, 0.0),
                                     std::span(&sun, 1), map, {});
    EXPECT_EQ(g.shadow_rays, 0u);
    for (const size_t bin : {0u, 27u, 63u}) {
      const double power_W = 1361 * 0.5 / 64;
      EXPECT_NEAR(g.direct.of(0)[map.entry(bin, 0)], power_W, 1e-6 * power_W) << radius_deg;
      EXPECT_NEAR(g.direct.of(0)[map.entry(bin, 0) + 1], 0.75 * power_W, 1e-6 * power_W);
    }
  }
}

TEST(Gather, SameBitsAtAnyNumberOfThreads) {
  const TraceableScene scene(shaded_square());
  const FluxMapReceiver map = map_of(scene.scene(), 40);
  const Beam beam = pillbox_disc("angle");
  std::vector<std::vector<double>> runs;
  for (const int threads : {1, 2, 7}) {
    GatherOptions options;
    options.threads = threads;
    runs.push_back(gather_direct(scene, {}, std::span(&beam, 1), map, options).direct.sums);
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_EQ(runs[0], runs[2]);
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

TEST(Gather, WhatNeedsRaysIsRefused) {
  Scene scene;
  add(scene, testing::sphere(0.1, 8), grey_surface("s", 0, 0), "receiver");
  SurfaceGridOptions options;
  options.facing_body = Vec3::UnitZ();
  const FluxMapReceiver map("receiver", scene, make_surface_grid(scene, {{0}}, options));
  const TraceableScene traceable(scene);
  const Beam beam = pillbox_disc("angle");
  EXPECT_THROW(gather_direct(traceable, {}, std::span(&beam, 1), map, {}), InputError);
}

// A map of 10,000 bins and 8.4 million rays: docs/benchmarks.md, "Scaling".
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
