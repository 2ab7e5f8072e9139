// Whether gathered light is as exact as it says for any profile, aperture, distance, tilt and bins.
#include <gtest/gtest.h>

#include <random>

#include "core/constants.h"
#include "raytrace/direct/disc_light.h"
#include "receivers/gather/gather.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque {
namespace {

using testing::number;
using testing::text;

// A lamp of one watt with a plate under it, drawn at random.
struct Draw {
  std::string description;
  Beam beam;
  Vec3 centre_m;       // of the plate, in the lamp's frame, as are the others
  Vec3 along, across;  // unit vectors in the plate; its front looks against the light
  double height_m;
  double foot_m;  // radius that all light is within at the height of the centre
};

class Lottery {
 public:
  explicit Lottery(uint32_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  Draw draw() {
    Draw d;
    SettingsNode::Table keys = profile();
    const double diameter_m = log_uniform(1e-4, 0.5);
    d.height_m = log_uniform(0.1, 5.0);
    keys["power_W"] = number(1.0);
    keys["aperture_diameter_m"] = number(diameter_m);
    d.beam = testing::source("led", keys, Vec3::Zero(), Vec3::UnitZ());
    const DiscLight light(*d.beam.emitter, *d.beam.aperture);
    d.foot_m = 0.5 * diameter_m + d.height_m * std::tan(light.reach_rad());
    const double steepest = 0.8 * std::min(1.0, 0.5 * pi - light.reach_rad());
    const double tilt = uniform(0.0, 1.0) < 0.2 ? 0.0 : uniform(0.0, std::min(steepest, 0.8));
    const Mat3 turned = (Eigen::AngleAxisd(uniform(0.0, 2 * pi), Vec3::UnitZ()) *
                         Eigen::AngleAxisd(tilt, Vec3::UnitX()) *
                         Eigen::AngleAxisd(uniform(0.0, 2 * pi), Vec3::UnitZ()))
                            .toRotationMatrix();
    d.along = turned.col(0);
    d.across = -turned.col(1);
    d.centre_m = {0.0, 0.0, d.height_m};
    char line[256];
    std::snprintf(line, sizeof line, "%s; aperture %.4g m at %.4g m, tilt %.3g rad",
                  profile_.c_str(), diameter_m, d.height_m, tilt);
    d.description = line;
    return d;
  }

 private:
  SettingsNode::Table profile() {
    const double width_deg = log_uniform(0.1, 12.0);
    char line[128];
    const auto called = [&](const char* name, double value) {
      std::snprintf(line, sizeof line, "%s %.4g, width %.4g deg", name, value, width_deg);
      profile_ = line;
    };
    switch (integer(0, 4)) {
      case 0: {
        const double order = log_uniform(2.0, 100.0);
        called("super_gaussian", order);
        return {{"profile", text("super_gaussian")},
                {"fwhm_deg", number(width_deg)},
                {"order", number(order)}};
      }
      case 1:
        called("core and halo", 0.2);
        return {{"profile", text("pillbox")},
                {"half_angle_deg", number(width_deg)},
                {"pillbox_measure", text("angle")},
                {"halo_fraction", number(0.2)},
                {"halo_fwhm_deg", number(2.0 * width_deg)}};
      case 2:
        called("gaussian", 2.0);
        return {{"profile", text("gaussian")}, {"fwhm_deg", number(width_deg)}};
      default: {
        const std::array<const char*, 3> measures = {"angle", "solid_angle", "projected"};
        const char* measure = measures[static_cast<size_t>(integer(0, 2))];
        called(measure, 0.0);
        return {{"profile", text("pillbox")},
                {"half_angle_deg", number(width_deg)},
                {"pillbox_measure", text(measure)}};
      }
    }
  }

  std::mt19937 random_;
  std::string profile_;
};

// The lit plate as a scene: sides in the lamp's frame.
Scene plate(const Draw& d, double length_m, double width_m) {
  Scene scene;
  testing::add(scene, testing::rectangle(d.centre_m, length_m * d.along, width_m * d.across),
               grey_surface("black", 0.0, 0.0), "receiver");
  return scene;
}

double light_radius_m(const Draw& d) {
  return d.beam.aperture->radius_m;
}

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
  Lottery lottery(15);
  for (int i = 0; i < 1000; ++i) {
    const Draw d = lottery.draw();
    const double lean = -d.along.cross(d.across).z();
    const double reach = d.foot_m / d.height_m;  // as if from a point: wider than the beam
    const double slant = std::sqrt(1.0 - lean * lean) / lean;
    const double side_m = 2.2 * d.foot_m / lean / std::max(0.1, 1.0 - reach * slant);
    const Scene scene = plate(d, side_m, side_m * lottery.uniform(1.0, 1.5));
    const TraceableScene traceable(scene);
    const FluxMapReceiver map = map_over(scene, lottery.integer(1, 50), lottery.integer(1, 50));
    const Gathered gathered = gather_direct(traceable, {}, std::span(&d.beam, 1), map,
                                            {.replicates = 2, .points = 1, .threads = 1});
    const double behind_m = light_radius_m(d) * slant - d.height_m;
    if (behind_m > 0.0) continue;  // the plate cuts through the aperture
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
  Lottery lottery(16);
  for (int i = 0; i < 150; ++i) {
    const Draw d = lottery.draw();
    const DiscLight light(*d.beam.emitter, *d.beam.aperture);
    // A bin about the rim of the light at half of the flux.
    const double radius_m =
        std::hypot(light.radius_m(), d.height_m * std::tan(light.half_flux_rad()));
    const double side_m = radius_m * lottery.log_uniform(0.02, 1.0);
    Draw moved = d;
    moved.centre_m += lottery.uniform(0.0, 1.3) * radius_m * d.along;
    const Scene scene = plate(moved, side_m, side_m);
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
  Lottery lottery(17);
  for (int i = 0; i < 200; ++i) {
    const Draw d = lottery.draw();
    const DiscLight light(*d.beam.emitter, *d.beam.aperture);
    const double within_m = lottery.uniform(0.0, 1.2) * d.foot_m;
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
