// Heliostats in the Sun: totals, peaks and maps of the flux on a receiver, against five ray tracers
// (SolTrace, Tonatiuh, Tracer, Solstice, Heliosim).
//
// Source of the cases, of every number in `cases` and of tests/data/heliostats.csv:
// github.com/anustg/optics-verification, commit 6a119fd2; Y. Wang et al., Solar Energy 195 (2020)
// 461. Geometry in the comment on build(). The places of the 522 mirrors of case C are read where
// third parties' files lie.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "raytrace/surfaces/mirrors.h"
#include "receivers/flux_map.h"
#include "tests/outside.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque {
namespace {

// Means of the five programs with three standard deviations between them: absorbed power [kW] and
// the brightest of 100 × 100 bins [kW/m²]; and peak_of() of their mean map.
struct HeliostatCase {
  const char* name;
  double absorbed_kW, absorbed_3sigma_kW, peak_kW_m2, peak_3sigma_kW_m2, map_peak_kW_m2;
};
constexpr HeliostatCase usual_cases[] = {
    {"A_1.2.3", 66.8369, 0.005165104, 1.795393, 0.02198667, 1.7686},
    {"A_2.3.3", 97.97153, 0.05731756, 6.768785, 0.1143731, 6.7278},
    {"B_1.1.1", 97.6562, 0.04090887, 68.66935, 0.1321962, 68.5553},
    {"B_1.2.4", 11.51386, 0.006200869, 0.2823004, 0.008777287, 0.2733},
    {"B_2.1.3", 50.81719, 0.05970667, 1.756696, 0.02430461, 1.7303},
    {"C_1.1", 32857.13, 7.209712, 4180.032, 25.21735, 4158.4479},
};
// Other sizes of the same effects, which take two thirds of the time: the table of
// docs/validation.md holds them. One of the five maps of A_1.1.2 is another's; there an even disc
// of 2 m holds all of 100 kW.
constexpr HeliostatCase further_cases[] = {
    {"A_1.1.2", 99.99758, 0.005633517, 8.073143, 0.09739896, 100.0 / (4.0 * pi)},
    {"A_1.2.1", 99.98508, 0.00859127, 15.93244, 0.02939985, 15.8700},
    {"A_2.1", 100.0004, 0.009583849, 8.083774, 0.08859027, 7.9584},
    {"A_2.3.1", 99.30486, 0.06890336, 6.90404, 0.09570854, 6.8737},
    {"B_1.1.3", 50.88898, 0.0108549, 1.734949, 0.02563425, 1.7072},
    {"B_1.2.2", 45.44831, 0.008599997, 1.690728, 0.02167538, 1.6694},
    {"B_2.1.1", 97.41373, 0.04808915, 69.28184, 0.2173246, 69.1772},
    {"B_2.2.2", 45.32314, 0.05627249, 1.711636, 0.01965085, 1.6900},
    {"B_2.2.4", 11.41448, 0.005947406, 0.2805586, 0.009679873, 0.2706},
    {"C_2.2", 22753.6, 35.34117, 1756.524, 42.883, 1737.0459},
};

struct Heliostat {
  Vec3 at_m;
  double focal_m;
};

// The parts of a case's name. Sun over north through east; shapes as the cases' list has them.
struct Layout {
  SettingsNode::Table sun;  // its shape
  std::shared_ptr<const Lobe> slope_error;
  Vec3 to_sun = Vec3::UnitZ(), aim_m{0, 0, 500};
  std::vector<Heliostat> mirrors = {{Vec3::Zero(), 500.0}};
  double reflectance = 1.0, absorptance = 1.0;
  bool upright = false;
};

SettingsNode::Table pillbox_sun(double radius_mrad) {
  return {{"angular_radius_deg", {1e-3 * radius_mrad / degree_rad}}};
}
SettingsNode::Table buie_sun(double ratio) {
  return {{"sun_shape", {"buie"}}, {"circumsolar_ratio", {ratio}}};
}

std::vector<Heliostat> field() {
  std::ifstream in(outside::third_party("reference/optics_verification/field.csv"));
  std::vector<Heliostat> mirrors;
  for (std::string line; std::getline(in, line);) {
    Heliostat mirror;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &mirror.at_m[0], &mirror.at_m[1],
                    &mirror.at_m[2], &mirror.focal_m) == 4) {
      mirrors.push_back(mirror);
    }
  }
  return mirrors;
}

Layout layout_of(const std::string& name) {
  Layout layout;
  const char group = name[0], first = name[2];
  const auto digit = [&](size_t at) { return static_cast<double>(name.at(at) - '0'); };
  if (group == 'A') {
    layout.sun = pillbox_sun(0.0);
    if (first == '1') {
      layout.slope_error =
          slope_error(1e-3 * digit(6), name[4] == '1' ? SlopeShape::pillbox : SlopeShape::gaussian);
    } else {
      layout.sun = name == "A_2.1" ? pillbox_sun(4.0) : buie_sun(0.01 * digit(6));
    }
    return layout;
  }
  layout.sun = first == '1' ? pillbox_sun(4.65) : buie_sun(0.02);
  layout.slope_error = slope_error(2e-3);
  const double azimuth = (name[4] == '1' ? 180.0 : 76.0) * degree_rad;
  const double zenith = (name[4] == '1' ? 12.0 : 68.0) * degree_rad;
  layout.to_sun = {std::sin(azimuth) * std::sin(zenith), std::cos(azimuth) * std::sin(zenith),
                   std::cos(zenith)};
  layout.upright = true;
  layout.aim_m = {0, 0, 62};
  if (group == 'B') {
    const Vec3 at_m[] = {{0, 46.5, 0}, {0, 536.9, 0}, {-324.3, 427.9, 0}, {252.5, 118.1, 0}};
    const Vec3& place_m = at_m[name[6] - '1'];
    layout.mirrors = {{place_m, (layout.aim_m - place_m).norm()}};
  } else {
    layout.mirrors = field();
    layout.reflectance = 0.95;
    layout.absorptance = 0.9;
  }
  return layout;
}

// Squares of 10 m of paraboloids z = r²/4f about normals that halve the angle of Sun and aim, lower
// edges level, backs black, `n` facets along a side; and the receiver, 8 m × 8 m looking down or 8
// m × 6 m looking north, which takes no light from behind and throws no shadow.
Scene build(const Layout& layout, uint32_t n) {
  Mesh mirrors;
  for (const Heliostat& one : layout.mirrors) {
    const Vec3 normal = (layout.to_sun + (layout.aim_m - one.at_m).normalized()).normalized();
    const Vec3 across = Vec3::UnitZ().cross(normal);
    const Vec3 level = across.norm() > 1e-9 ? across.normalized() : Vec3(Vec3::UnitX());
    const Vec3 up = normal.cross(level);
    const auto first = static_cast<uint32_t>(mirrors.vertices_m.size());
    for (uint32_t j = 0; j <= n; ++j) {
      for (uint32_t i = 0; i <= n; ++i) {
        const double u = 10.0 * i / n - 5.0, v = 10.0 * j / n - 5.0;
        mirrors.vertices_m.push_back(one.at_m + u * level + v * up +
                                     (u * u + v * v) / (4.0 * one.focal_m) * normal);
      }
    }
    for (uint32_t j = 0; j < n; ++j) {
      for (uint32_t i = 0; i < n; ++i) {
        const uint32_t a = first + j * (n + 1) + i;
        mirrors.triangles.push_back({a, a + 1, a + n + 2});
        mirrors.triangles.push_back({a, a + n + 2, a + n + 1});
      }
    }
  }
  Scene scene;
  OpticalSurface mirror = grey_surface("mirror", layout.reflectance, 0.0);
  Bsdf bsdf;
  bsdf.specular = layout.slope_error;
  mirror.bsdf = std::make_shared<const Bsdf>(std::move(bsdf));
  fixtures::add(scene, std::move(mirrors), mirror, "mirrors");
  scene.surfaces.push_back(grey_surface("black", 0, 0));
  scene.instances.back().back_surface = static_cast<uint32_t>(scene.surfaces.size() - 1);
  const Vec3 u_m(layout.upright ? -8.0 : 8.0, 0, 0);
  const Vec3 v_m = layout.upright ? Vec3(0, 0, 6.0) : Vec3(0, -8.0, 0);
  fixtures::add(scene, fixtures::rectangle(layout.aim_m, u_m, v_m),
                grey_surface("receiver", 0.0, 1.0 - layout.absorptance), "receiver");
  scene.surfaces.push_back(grey_surface("nothing", 0, 0, 1.0));
  scene.instances.back().back_surface = static_cast<uint32_t>(scene.surfaces.size() - 1);
  return scene;
}

struct Flux {
  Estimate absorbed_W;
  std::vector<double> bins_kW_m2;           // 100 × 100
  std::vector<std::vector<double>> blocks;  // 20 × 20 of a replicate [kW/m²]
  double seconds = 0.0;                     // of CPU
};

constexpr size_t side = 100, block_side = 20, per_block = side / block_side;

std::vector<double> blocks_of(const std::vector<Estimate>& bins_W_m2) {
  std::vector<double> blocks(block_side * block_side, 0.0);
  for (size_t y = 0; y < side; ++y) {
    for (size_t x = 0; x < side; ++x) {
      blocks[y / per_block * block_side + x / per_block] +=
          1e-3 * bins_W_m2[y * side + x].value / (per_block * per_block);
    }
  }
  return blocks;
}

Flux trace_case(const Layout& layout, uint32_t facets, uint64_t rays) {
  const std::clock_t start = std::clock();
  const Scene scene = build(layout, facets);
  const double radius_m = scene.radius_m();
  SettingsNode::Table keys = layout.sun;
  keys["irradiance_W_m2"] = {1000.0};
  const Beam sun = fixtures::source("sun", std::move(keys), Vec3::Zero(), -layout.to_sun, radius_m);
  const FluxMapReceiver map("receiver", scene,
                            make_surface_grid(scene, scene.instances_of("receiver"), {}));
  const TraceableScene traceable(scene);
  const Receiver* const receivers[] = {&map};
  const TraceOptions options{.rays = rays};
  BinSums sums = trace(traceable, {}, std::span(&sun, 1), receivers, options).sums[0];
  // The cases count mirrored light alone; at low sun its own light falls on the receiver's front.
  for (int r = 0; r < options.replicates; ++r) {
    const auto first = sums.sums.begin() + static_cast<std::ptrdiff_t>(sums.bins) * r;
    std::fill_n(first, map.direct_entries(), 0.0);
  }
  const FluxMap flux = map.flux_map(sums);
  Flux found;
  found.absorbed_W = flux.absorbed.power_W;
  for (const Estimate& bin : flux.absorbed.per_bin_W_m2) {
    found.bins_kW_m2.push_back(1e-3 * bin.value);
  }
  for (int r = 0; r < options.replicates; ++r) {
    BinSums twice{sums.bins, 2, {}};  // an estimate needs two replicates
    for (int copy = 0; copy < 2; ++copy) {
      twice.sums.insert(twice.sums.end(), sums.of(r).begin(), sums.of(r).end());
    }
    found.blocks.push_back(blocks_of(map.flux_map(twice).absorbed.per_bin_W_m2));
  }
  found.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return found;
}

// The top of the map without the noise of its brightest bin, and its standard error: a paraboloid
// through the logarithms of all bins above nine tenths of the brightest 3 × 3.
Estimate peak_of(const std::vector<double>& bins) {
  std::vector<double> smooth(bins.size(), 0.0);
  for (size_t y = 1; y + 1 < side; ++y) {
    for (size_t x = 1; x + 1 < side; ++x) {
      for (size_t j = y - 1; j <= y + 1; ++j) {
        for (size_t i = x - 1; i <= x + 1; ++i) smooth[y * side + x] += bins[j * side + i] / 9;
      }
    }
  }
  const double level = 0.9 * *std::max_element(smooth.begin(), smooth.end());
  std::vector<size_t> top;
  for (size_t at = 0; at < bins.size(); ++at) {
    if (smooth[at] >= level && bins[at] > 0.0) top.push_back(at);
  }
  const auto count = static_cast<Eigen::Index>(top.size());
  Eigen::MatrixXd terms(count, 6);
  Eigen::VectorXd logs(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const size_t at = top[static_cast<size_t>(k)];
    const double x = static_cast<double>(at % side) / side - 0.5;
    const double y = static_cast<double>(at / side) / side - 0.5;
    terms.row(k) << 1, x, y, x * x, x * y, y * y;
    logs[k] = std::log(bins[at]);
  }
  const Eigen::MatrixXd inverse = (terms.transpose() * terms).inverse();
  const Eigen::VectorXd fit = inverse * (terms.transpose() * logs);
  Eigen::Index highest = 0;
  const double peak = std::exp((terms * fit).maxCoeff(&highest));
  const double variance = (logs - terms * fit).squaredNorm() / static_cast<double>(count - 6);
  const Eigen::VectorXd there = terms.row(highest);
  return {peak, peak * std::sqrt(variance * there.dot(inverse * there))};
}

// The mean map of the five programs and their spread over blocks [kW/m²].
struct OtherMap {
  std::vector<double> mean, spread;
};
OtherMap others(const std::string& name) {
  std::ifstream in(outside::reference_data("heliostats.csv"));
  OtherMap found;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(name + ",")) continue;
    std::istringstream values(line.substr(name.size() + 1));
    std::vector<double> numbers;
    for (std::string value; std::getline(values, value, ',');) numbers.push_back(std::stod(value));
    if (numbers.size() != 1 + 2 * block_side) return {};
    const auto deviations = numbers.begin() + 1 + block_side;
    found.mean.insert(found.mean.end(), numbers.begin() + 1, deviations);
    found.spread.insert(found.spread.end(), deviations, numbers.end());
  }
  return found;
}

// χ² per block between our map and the mean of the others, with their spread, that of a sixth
// program about the mean of five, and our error; in the orientation that fits best.
double map_chi2(const Flux& flux, const OtherMap& others) {
  const auto& [mean, spread] = others;
  const double brightest = *std::max_element(mean.begin(), mean.end());
  double best = std::numeric_limits<double>::max();
  for (const bool flip_x : {false, true}) {
    for (const bool flip_y : {false, true}) {
      double chi2 = 0.0;
      int blocks = 0;
      for (size_t y = 0; y < block_side; ++y) {
        for (size_t x = 0; x < block_side; ++x) {
          const size_t theirs = y * block_side + x;
          if (mean[theirs] < 0.01 * brightest) continue;
          const size_t ours =
              (flip_y ? block_side - 1 - y : y) * block_side + (flip_x ? block_side - 1 - x : x);
          std::vector<double> values;
          for (const std::vector<double>& replicate : flux.blocks)
            values.push_back(replicate[ours]);
          const Estimate own = estimate_from_replicates(values);
          const double variance =
              1.2 * spread[theirs] * spread[theirs] + own.standard_error * own.standard_error;
          chi2 += std::pow(own.value - mean[theirs], 2) / variance;
          ++blocks;
        }
      }
      best = std::min(best, chi2 / blocks);
    }
  }
  return best;
}

class Heliostats : public ::testing::TestWithParam<HeliostatCase> {};

TEST_P(Heliostats, AgreeWithFiveRayTracers) {
  const HeliostatCase& truth = GetParam();
  const std::string name = truth.name;
  if (name[0] == 'C') PHOTORQUE_NEEDS_THIRD_PARTY("reference/optics_verification/field.csv");
  const Layout layout = layout_of(name);
  // Flat facets blur by their size: less than the bins, in C than its smallest images.
  const uint32_t facets = name[0] == 'A' ? 400 : name[0] == 'B' ? 200 : 80;
  const Flux flux = trace_case(layout, facets, 1ull << 23);
  const double absorbed_kW = 1e-3 * flux.absorbed_W.value;
  const Estimate peak = peak_of(flux.bins_kW_m2);
  // The programs find χ of Buie's law by fits, which for a ratio of 0.03 err to the same side (one
  // published polynomial gives 0.0303): with the paper's ratio 98.04 kW are 1.25 times as far off.
  const double known = name == "A_2.3.3" ? 1.5 : 1.0;
  EXPECT_NEAR(absorbed_kW, truth.absorbed_kW,
              known * truth.absorbed_3sigma_kW + 3e-3 * flux.absorbed_W.standard_error);
  const OtherMap map = others(name);
  ASSERT_EQ(map.mean.size(), block_side * block_side);
  const double chi2 = map_chi2(flux, map);
  EXPECT_LT(chi2, 1.5);
  EXPECT_NEAR(peak.value, truth.map_peak_kW_m2,
              truth.peak_3sigma_kW_m2 + 3.0 * peak.standard_error);
  // A row of the table in docs/validation.md.
  std::printf(
      "| `%s` | %.3f ± %.3f | %.3f ± %.3f | %.4f ± %.4f | %.4f | %.4f ± %.4f | %.2f | %.1f |\n",
      truth.name, absorbed_kW, 1e-3 * flux.absorbed_W.standard_error, truth.absorbed_kW,
      truth.absorbed_3sigma_kW, peak.value, peak.standard_error, truth.map_peak_kW_m2,
      truth.peak_kW_m2, truth.peak_3sigma_kW_m2, chi2, flux.seconds);
}

std::string name_of_case(const ::testing::TestParamInfo<HeliostatCase>& tested) {
  std::string name = tested.param.name;
  std::ranges::replace(name, '.', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Heliostats, ::testing::ValuesIn(usual_cases), name_of_case);
INSTANTIATE_TEST_SUITE_P(DISABLED_Cases, Heliostats, ::testing::ValuesIn(further_cases),
                         name_of_case);

}  // namespace
}  // namespace photorque
