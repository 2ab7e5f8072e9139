// Lamps, plate, walls and shadows of an injected case, and the light that arrives: plain
// quadrature over the lamps' apertures, nothing shared with the program's own light.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "attitude/injection/vectors.h"

namespace photorque::injected {

// A round aperture that shines evenly; its intensity falls with the angle to its axis.
struct InjectedLamp {
  enum class Profile { gaussian, super_gaussian, cosine_power };
  Triple position_m = {}, axis = {0, 0, -1};  // lab
  double power_W = 1.0, radius_m = 0.01;
  Profile profile = Profile::gaussian;
  double fwhm_rad = 0.1, order = 2.0, exponent = 10.0;

  // Intensity over that on the axis.
  double fall(double angle_rad) const;
  // Makes ready: what a unit of flux gives on the axis [1/sr].
  double on_axis_per_sr() const;
};

// A rectangle across body x (axis 0) or body y (axis 1), seen from the side `facing`.
struct InjectedWall {
  size_t axis = 0;
  double at_m = 0.0, from_m = 0.0, to_m = 0.0, bottom_m = 0.0, top_m = 0.0;
  double facing = 1.0;
  double diffuse = 0.0, specular = 0.0;
};

// An opaque box with sides along the axes of the lab or the body.
struct InjectedBox {
  bool on_body = false;
  Triple low_m = {}, high_m = {};
};

// The plate looks up (body z); map coordinates are body x and y.
struct InjectedPlate {
  double u_low_m = 0.0, u_high_m = 0.0, v_low_m = 0.0, v_high_m = 0.0, z_m = 0.0;
};

struct InjectedLight {
  std::vector<InjectedLamp> lamps;
  InjectedPlate plate;
  std::vector<InjectedWall> walls;
  std::vector<InjectedBox> boxes;
  double ambient_W_m2 = 0.0;
  std::array<double, 2> bias_rad = {0.0, 0.0};
  std::optional<double> glass_index;  // of a cover over the cells

  // Per watt of one lamp, what was computed before; copies share it. Not for two threads at once.
  using Known = std::map<std::vector<double>, std::vector<double>>;
  std::shared_ptr<Known> known = std::make_shared<Known>();
};

// Irradiance [W/m²] on points of the plate (body x, y), at an attitude (lab from body). Through the
// glass, where `into_cells`.
std::vector<double> injected_light(const InjectedLight& world, const Quaternion& attitude,
                                   const std::vector<std::array<double, 2>>& points_m,
                                   bool into_cells);
// At which points some lamp may be hidden in part.
std::vector<bool> may_be_shaded(const InjectedLight& world, const Quaternion& attitude,
                                const std::vector<std::array<double, 2>>& points_m);

}  // namespace photorque::injected
