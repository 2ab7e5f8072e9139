#include "receivers/flux_map.h"

#include <random>

#include "receiver_scenes.h"

namespace photorque {
namespace {

using fixtures::add_instance;
using fixtures::box;
using fixtures::HitMaker;
using fixtures::map_named;
using fixtures::plate;
using fixtures::polygon;
using fixtures::quantity_named;
using fixtures::scene_of;
using fixtures::sums_of;

FluxMapReceiver receiver_on(const Scene& scene, int width, int height,
                            SurfaceGridOptions options = SurfaceGridOptions()) {
  options.width = width;
  options.height = height;
  const uint32_t instances[] = {0};
  return {"plate", scene, make_surface_grid(scene, instances, options)};
}

HitMaker power_at(double x, double y, double incident_W, double absorbed_W = 0.0) {
  HitMaker hit;
  hit.position_m = {x, y, 0};
  hit.incident_W = {incident_W};
  hit.absorbed_W = {absorbed_W};
  return hit;
}

TEST(FluxMap, PowerInABinOverItsArea) {
  // Bins of 1 m × 1.5 m; the second hit lies in the bin right and above.
  const Scene scene = scene_of(plate(-1, 1, 0, 3));
  const FluxMapReceiver receiver = receiver_on(scene, 2, 2);
  const std::vector<HitMaker> hits = {power_at(-0.5, 0.5, 3.0, 1.5), power_at(0.01, 1.51, 6.0, 4.5),
                                      power_at(0.99, 2.99, 3.0, 3.0)};
  const FluxMap map = receiver.flux_map(sums_of(receiver, {hits, hits}));
  const std::vector<double> incident = {2.0, 0.0, 0.0, 6.0}, absorbed = {1.0, 0.0, 0.0, 5.0};
  for (size_t bin = 0; bin < 4; ++bin) {
    EXPECT_NEAR(map.incident.per_bin_W_m2[bin].value, incident[bin], 1e-14);
    EXPECT_NEAR(map.absorbed.per_bin_W_m2[bin].value, absorbed[bin], 1e-14);
    EXPECT_EQ(map.incident.per_bin_W_m2[bin].standard_error, 0.0);
  }
  EXPECT_NEAR(map.incident.power_W.value, 12.0, 1e-14);
  EXPECT_NEAR(map.absorbed.power_W.value, 9.0, 1e-14);
}

TEST(FluxMap, UniformLightIsUniformInPartlyCoveredBins) {
  // The square |x| + |y| ≤ 1 on 4 × 4 bins has whole, half and empty ones. Light of 1000 W/m²
  // brings each the power of its known area.
  const Scene scene = scene_of(polygon(4));
  const FluxMapReceiver receiver = receiver_on(scene, 4, 4);
  const double whole = 0.25, half = 0.125;
  std::vector<HitMaker> hits;
  for (const double x : {-0.25, 0.25}) {
    for (const double y : {-0.25, 0.25}) {
      hits.push_back(power_at(x, y, 1000 * whole));
      hits.push_back(power_at(2.2 * x, y, 1000 * half));
      hits.push_back(power_at(x, 2.2 * y, 1000 * half));
    }
  }
  const BinSums sums = sums_of(receiver, {hits, hits});
  const Map irradiance = map_named(receiver.product(sums), "irradiance_plate");
  int covered = 0;
  for (const double value : irradiance.value) {
    if (std::isnan(value)) continue;
    EXPECT_NEAR(value, 1000.0, 1e-10);
    ++covered;
  }
  EXPECT_EQ(covered, 12);
  EXPECT_TRUE(std::isnan(irradiance.value[0]) && std::isnan(irradiance.standard_error[0]));
}

TEST(FluxMap, SideDecidesWhichHitsCount) {
  const Scene scene = scene_of(plate(0, 1, 0, 1));
  std::vector<HitMaker> hits = {power_at(0.5, 0.5, 1.0), power_at(0.5, 0.5, 10.0)};
  hits[1].front = false;
  const std::pair<Side, double> cases[] = {
      {Side::front, 1.0}, {Side::back, 10.0}, {Side::both, 11.0}};
  for (const auto& [side, expected_W] : cases) {
    SurfaceGridOptions options;
    options.side = side;
    const FluxMapReceiver receiver = receiver_on(scene, 3, 3, options);
    EXPECT_EQ(receiver.flux_map(sums_of(receiver, {hits, hits})).incident.power_W.value,
              expected_W);
  }
}

TEST(FluxMap, FacingLeavesOutTrianglesTurnedAway) {
  const Scene scene = scene_of(box({-1, -1, -0.1}, {1, 1, 0.1}));
  SurfaceGridOptions options;
  options.facing_body = Vec3::UnitZ();
  const FluxMapReceiver receiver = receiver_on(scene, 2, 2, options);
  std::vector<HitMaker> hits;
  for (uint32_t triangle = 0; triangle < 12; ++triangle) {
    hits.push_back(power_at(0.5, 0.5, std::pow(2.0, triangle)));
    hits.back().triangle = triangle;
  }
  // The last two triangles of the box are its top.
  EXPECT_EQ(receiver.flux_map(sums_of(receiver, {hits, hits})).incident.power_W.value,
            1024.0 + 2048.0);
}

TEST(FluxMap, TextureBinsFollowTheCorners) {
  const Scene scene = scene_of(plate(0, 1, 0, 1));
  SurfaceGridOptions options;
  options.over = SurfaceGrid::Over::texture;
  const FluxMapReceiver receiver = receiver_on(scene, 10, 10, options);
  // Triangle 0 has texture corners (0,0), (1,0), (1,1); weights 1/2 and 1/4 are (0.75, 0.25).
  // Triangle 1 has (0,0), (1,1), (0,1); the same weights are (0.5, 0.75).
  HitMaker a = power_at(0, 0, 1.0), b = power_at(0, 0, 2.0);
  a.barycentric = b.barycentric = {0.5, 0.26};
  b.triangle = 1;
  const BinSums sums = sums_of(receiver, {{a, b}, {a, b}});
  const FluxMap map = receiver.flux_map(sums);
  EXPECT_NEAR(map.incident.per_bin_W_m2[2 * 10 + 7].value, 100.0, 1e-9);
  EXPECT_NEAR(map.incident.per_bin_W_m2[7 * 10 + 5].value, 200.0, 1e-9);
}

TEST(FluxMap, ManyHitsInOneBatchAllCount) {
  // Sums over a full batch in every grouping of instances that the fast loops distinguish.
  Scene scene = scene_of(plate(0, 1, 0, 1));
  add_instance(scene, plate(0, 1, 0, 1, 2.0), "other");
  const FluxMapReceiver receiver = receiver_on(scene, 5, 5);
  for (const int period : {1, 2, 3, 7, 100, 256, 1024}) {
    std::vector<HitMaker> hits;
    double expected_W = 0.0;
    for (int i = 0; i < Hits::capacity; ++i) {
      const int column = i % 32, row = i / 32;
      hits.push_back(power_at((column + 0.5) / 32, (row + 0.5) / 32, i + 1.0));
      hits.back().instance = i % (2 * period) < period ? 0 : 1;
      if (hits.back().instance == 0) expected_W += i + 1.0;
    }
    const FluxMap map = receiver.flux_map(sums_of(receiver, {hits, hits}));
    EXPECT_EQ(map.incident.power_W.value, expected_W) << period;
    double sum_W = 0.0;
    for (const Estimate& bin : map.incident.per_bin_W_m2) sum_W += bin.value / 25;
    EXPECT_NEAR(sum_W, expected_W, 1e-9) << period;
  }
}

TEST(FluxMap, BandsAreKeptApart) {
  Scene scene = scene_of(plate(0, 1, 0, 1));
  scene.bands.edges_m = {0.0, 700e-9, 760e-9, 1.0};
  const FluxMapReceiver receiver = receiver_on(scene, 1, 1);
  HitMaker hit = power_at(0.5, 0.5, 0.0);
  hit.incident_W = {1, 2, 4};
  hit.absorbed_W = {0.5, 0.25, 0.125};
  const BinSums sums = sums_of(receiver, {{hit}, {hit}});
  const Product product = receiver.product(sums);
  EXPECT_EQ(map_named(product, "irradiance_plate").value[0], 7.0);
  EXPECT_EQ(map_named(product, "irradiance_plate_below_700nm").value[0], 1.0);
  EXPECT_EQ(map_named(product, "irradiance_plate_700-760nm").value[0], 2.0);
  EXPECT_EQ(map_named(product, "irradiance_plate_above_760nm").value[0], 4.0);
  EXPECT_EQ(map_named(product, "absorbed_plate_700-760nm").value[0], 0.25);
  EXPECT_EQ(quantity_named(product, "power_absorbed_by_plate_W").value, 0.875);
}

TEST(FluxMap, StandardErrorsComeFromReplicates) {
  // Left bin 1, 2, 6 W and right bin 6, 5, 1 W in three replicates: the mean of the left is 3 and
  // its standard error √((4 + 1 + 9)/(3·2)) = √(7/3); the total is 7 W in each and has no error.
  const Scene scene = scene_of(plate(0, 2, 0, 1));
  const FluxMapReceiver receiver = receiver_on(scene, 2, 1);
  const BinSums sums = sums_of(receiver, {{power_at(0.5, 0.5, 1), power_at(1.5, 0.5, 6)},
                                          {power_at(0.5, 0.5, 2), power_at(1.5, 0.5, 5)},
                                          {power_at(0.5, 0.5, 6), power_at(1.5, 0.5, 1)}});
  const FluxMap map = receiver.flux_map(sums);
  EXPECT_NEAR(map.incident.per_bin_W_m2[0].value, 3.0, 1e-14);
  EXPECT_NEAR(map.incident.per_bin_W_m2[0].standard_error, std::sqrt(7.0 / 3.0), 1e-14);
  EXPECT_NEAR(map.incident.power_W.value, 7.0, 1e-14);
  EXPECT_NEAR(map.incident.power_W.standard_error, 0.0, 1e-14);
}

TEST(FluxStatistics, OfFourKnownBins) {
  const Scene scene = scene_of(plate(0, 4, 0, 1));
  const FluxMapReceiver receiver = receiver_on(scene, 4, 1);
  std::vector<HitMaker> hits;
  for (int i = 0; i < 4; ++i) hits.push_back(power_at(i + 0.5, 0.5, i + 1.0));
  const BinSums sums = sums_of(receiver, {hits, hits});
  const FluxStatistics statistics = flux_statistics(receiver, receiver.flux_map(sums), sums);
  EXPECT_NEAR(statistics.mean_W_m2.value, 2.5, 1e-14);
  EXPECT_NEAR(statistics.min_W_m2.value, 1.0, 1e-14);
  EXPECT_NEAR(statistics.max_W_m2.value, 4.0, 1e-14);
  EXPECT_NEAR(statistics.uniformity.value, 0.4, 1e-14);
  EXPECT_NEAR(statistics.variation.value, std::sqrt(1.25) / 2.5, 1e-12);
  EXPECT_EQ(statistics.relative_error, 0.0);
}

TEST(FluxStatistics, ExtremesIgnoreSlivers) {
  // A wedge that tapers to nothing at x = 8: the last bin holds 1/15 of the surface of the first
  // and 1/7 of a middle one. A stray hit there would be the maximum.
  Mesh wedge;
  wedge.vertices_m = {{0, -1, 0}, {20, 0, 0}, {0, 1, 0}};
  wedge.triangles = {{0, 1, 2}};
  const Scene scene = scene_of(wedge);
  const FluxMapReceiver receiver = receiver_on(scene, 20, 1);
  std::vector<HitMaker> hits;
  // Bin i spans x in [i, i + 1] and holds (2·20 − 2 i − 1)/20 m².
  for (int i = 0; i < 20; ++i) hits.push_back(power_at(i + 0.5, 0, (39.0 - 2 * i) / 20));
  hits.push_back(power_at(19.5, 0, 100.0));
  const BinSums sums = sums_of(receiver, {hits, hits});
  const FluxStatistics statistics = flux_statistics(receiver, receiver.flux_map(sums), sums);
  EXPECT_NEAR(statistics.max_W_m2.value, 1.0, 1e-12);
  EXPECT_NEAR(statistics.min_W_m2.value, 1.0, 1e-12);
}

TEST(FluxStatistics, VariationOfNoisyUniformLightIsZeroWithinItsError) {
  const Scene scene = scene_of(plate(0, 1, 0, 1));
  const FluxMapReceiver receiver = receiver_on(scene, 100, 100);
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(1.0, 0.2);
  BinSums sums{receiver.bins(), 16, {}};
  for (int r = 0; r < 16; ++r) {
    for (size_t i = 0; i < sums.bins / 2; ++i) sums.sums.push_back(1e-4 * noise(random));
    sums.sums.resize(sums.sums.size() + sums.bins / 2, 0.0);  // nothing bounced
  }
  const FluxMap map = receiver.flux_map(sums);
  const FluxStatistics statistics = flux_statistics(receiver, map, sums);
  // Each bin has a relative standard error of 0.2/√16 = 0.05, which a plain coefficient of
  // variation would report as structure. What remains of its square has a deviation of
  // 0.05²·√(2/10⁴).
  EXPECT_LT(statistics.variation.value, std::sqrt(3 * 0.0025 * std::sqrt(2e-4)));
  EXPECT_NEAR(statistics.relative_error, 0.05, 0.002);
  double squares = 0.0;
  for (const Estimate& bin : map.incident.per_bin_W_m2) squares += std::pow(bin.value - 1.0, 2);
  EXPECT_GT(std::sqrt(squares / 1e4), 0.045);
}

TEST(FluxMap, ProductNamesItsAxesAndUnits) {
  const Scene scene = scene_of(plate(-1, 1, 0, 3));
  const FluxMapReceiver receiver = receiver_on(scene, 4, 6);
  const BinSums sums = sums_of(receiver, {{power_at(0, 1, 2.0)}, {power_at(0, 1, 4.0)}});
  const Product product = receiver.product(sums);
  const Map& map = map_named(product, "irradiance_plate");
  EXPECT_EQ(map.unit, "W/m²");
  EXPECT_EQ(map.x_label, "x [m]");
  EXPECT_EQ(map.y_label, "y [m]");
  EXPECT_EQ(map.width, 4);
  EXPECT_EQ(map.height, 6);
  EXPECT_EQ(map.x_low, -1.0);
  EXPECT_EQ(map.y_high, 3.0);
  EXPECT_FALSE(map.signed_values);
  EXPECT_EQ(quantity_named(product, "power_on_plate_W").value, 3.0);
  EXPECT_EQ(quantity_named(product, "power_on_plate_W").standard_error, 1.0);
  EXPECT_NEAR(quantity_named(product, "area_plate_m2").value, 6.0, 1e-14);
}

}  // namespace
}  // namespace photorque
