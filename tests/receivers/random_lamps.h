// Lamps over plates, drawn at random.
#pragma once

#include <array>
#include <cstdio>
#include <random>
#include <string>

#include "core/constants.h"
#include "raytrace/direct/disc_light.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque::fixtures {

// A lamp of one watt with a plate under it, drawn at random.
struct Draw {
  std::string description;
  Beam beam;
  Vec3 centre_m;       // of the plate, in the lamp's frame, as are the others
  Vec3 along, across;  // unit vectors in the plate; its front looks against the light
  double height_m;
  double foot_m;  // radius that all light is within at the height of the centre
};

class RandomLamps {
 public:
  explicit RandomLamps(uint32_t seed) : random_(seed) {}

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
    keys["power_W"] = {1.0};
    keys["aperture_diameter_m"] = {diameter_m};
    d.beam = source("led", keys, Vec3::Zero(), Vec3::UnitZ());
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
        return {{"profile", {"super_gaussian"}}, {"fwhm_deg", {width_deg}}, {"order", {order}}};
      }
      case 1:
        called("core and halo", 0.2);
        return {{"profile", {"pillbox"}},
                {"half_angle_deg", {width_deg}},
                {"pillbox_measure", {"angle"}},
                {"halo_fraction", {0.2}},
                {"halo_fwhm_deg", {2.0 * width_deg}}};
      case 2:
        called("gaussian", 2.0);
        return {{"profile", {"gaussian"}}, {"fwhm_deg", {width_deg}}};
      default: {
        const std::array<const char*, 3> measures = {"angle", "solid_angle", "projected"};
        const char* measure = measures[static_cast<size_t>(integer(0, 2))];
        called(measure, 0.0);
        return {{"profile", {"pillbox"}},
                {"half_angle_deg", {width_deg}},
                {"pillbox_measure", {measure}}};
      }
    }
  }

  std::mt19937 random_;
  std::string profile_;
};

// The lit plate as a scene: sides in the lamp's frame.
inline Scene plate_of(const Draw& d, double length_m, double width_m) {
  Scene scene;
  add(scene, rectangle(d.centre_m, length_m * d.along, width_m * d.across),
      grey_surface("black", 0.0, 0.0), "receiver");
  return scene;
}

inline double light_radius_m(const Draw& d) {
  return d.beam.aperture->radius_m;
}

// A plate about the draw's centre that all of the lamp's light falls on; nothing where it would cut
// through the aperture.
inline std::optional<Scene> wide_plate(const Draw& d, double aspect) {
  const double lean = -d.along.cross(d.across).z();
  const double slant = std::sqrt(1.0 - lean * lean) / lean;
  if (light_radius_m(d) * slant > d.height_m) return std::nullopt;
  const double reach = d.foot_m / d.height_m;  // as if from a point: wider than the beam
  const double side_m = 2.2 * d.foot_m / lean / std::max(0.1, 1.0 - reach * slant);
  return plate_of(d, side_m, side_m * aspect);
}

}  // namespace photorque::fixtures
