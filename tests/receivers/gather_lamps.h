// Lamps and a scene for tests of gathering.
#pragma once

#include <stdexcept>
#include <string>

#include "receivers/flux_map.h"
#include "sources/lamps/kind.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque::fixtures {

inline SettingsNode number(double x) {
  return {x, {}};
}
inline SettingsNode text(const char* t) {
  return {std::string(t), {}};
}
inline SettingsNode vector(const Vec3& v) {
  return {SettingsNode::Array{number(v.x()), number(v.y()), number(v.z())}, {}};
}

// One source of the given kind at `at_m`, looking along `direction` at a scene of this radius.
inline Beam source(const char* which, SettingsNode::Table keys, const Vec3& at_m = {0, 0, 1.5},
                   const Vec3& direction = {0, 0, -1}, double scene_radius_m = 1.0) {
  keys["direction"] = vector(direction);
  if (std::string(which) == "led") {
    keys["position_m"] = vector(at_m);
    keys["wavelength_nm"] = number(730);
  }
  const Settings settings(std::make_shared<const SettingsNode>(SettingsNode{std::move(keys), {}}));
  for (const SourceKind& kind : all_source_kinds()) {
    if (kind.name == which)
      return kind.make(settings, {.scene_radius_m = scene_radius_m, .notice = {}})[0];
  }
  throw std::logic_error("no such source");
}

inline Beam lambertian_disc(double diameter_m) {
  return source("led", {{"power_W", number(2.0)},
                        {"aperture_diameter_m", number(diameter_m)},
                        {"profile", text("cosine_power")},
                        {"exponent", number(1.0)}});
}

inline Beam gaussian_led(double diameter_m, double fwhm_deg, const Vec3& at_m,
                         const Vec3& direction) {
  return source("led",
                {{"power_W", number(1.0)},
                 {"aperture_diameter_m", number(diameter_m)},
                 {"profile", text("gaussian")},
                 {"fwhm_deg", number(fwhm_deg)}},
                at_m, direction);
}

inline Beam pillbox_disc(const char* measure) {
  return source("led", {{"power_W", number(1.0)},
                        {"aperture_diameter_m", number(0.4)},
                        {"profile", text("pillbox")},
                        {"half_angle_deg", number(1.5)},
                        {"pillbox_measure", text(measure)}});
}

// A square of 1 m and, half a metre above it, a box.
inline Scene shaded_square() {
  Scene scene;
  const auto black = grey_surface("black", 0.1, 0.2);
  add(scene, rectangle(Vec3::Zero(), Vec3(0.5, 0, 0), Vec3(0, 0.5, 0)), black, "receiver");
  add(scene, box(Vec3(0, -0.02, 0.5), Vec3(0.1, 0.08, 0.55)), black, "box");
  return scene;
}

inline FluxMapReceiver map_of(const Scene& scene, int bins) {
  SurfaceGridOptions options;
  options.width = options.height = bins;
  return {"receiver", scene, make_surface_grid(scene, scene.instances_of("receiver"), options)};
}

}  // namespace photorque::fixtures
