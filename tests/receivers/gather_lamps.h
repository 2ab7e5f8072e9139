// Lamps and a scene for tests of gathering.
#pragma once

#include <string>

#include "receivers/flux_map.h"
#include "tests/raytrace/test_scenes.h"
#include "tests/settings.h"

namespace photorque::fixtures {

// One source of the given kind at `at_m`, looking along `direction` at a scene of this radius.
inline Beam source(const char* kind, SettingsNode::Table keys, const Vec3& at_m = {0, 0, 1.5},
                   const Vec3& direction = {0, 0, -1}, double scene_radius_m = 1.0) {
  keys["direction"] = test::vector_node(direction.x(), direction.y(), direction.z());
  if (std::string(kind) == "led") {
    keys["position_m"] = test::vector_node(at_m.x(), at_m.y(), at_m.z());
    keys["wavelength_nm"] = {730.0};
  }
  return test::make_beams(kind, std::move(keys), {.scene_radius_m = scene_radius_m})[0];
}

inline Beam lambertian_disc(double diameter_m) {
  return source("led", {{"power_W", {2.0}},
                        {"aperture_diameter_m", {diameter_m}},
                        {"profile", {"cosine_power"}},
                        {"exponent", {1.0}}});
}

inline Beam gaussian_led(double diameter_m, double fwhm_deg, const Vec3& at_m,
                         const Vec3& direction) {
  return source("led",
                {{"power_W", {1.0}},
                 {"aperture_diameter_m", {diameter_m}},
                 {"profile", {"gaussian"}},
                 {"fwhm_deg", {fwhm_deg}}},
                at_m, direction);
}

inline Beam pillbox_disc(const char* measure) {
  return source("led", {{"power_W", {1.0}},
                        {"aperture_diameter_m", {0.4}},
                        {"profile", {"pillbox"}},
                        {"half_angle_deg", {1.5}},
                        {"pillbox_measure", {measure}}});
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
