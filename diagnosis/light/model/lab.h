// The nominal model of lamps, receiver and array, prepared for the forward model of light.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/keys.h"
#include "photovoltaics/network/string.h"
#include "raytrace/direct/disc_light.h"
#include "scenes/effects/parts.h"

namespace photorque {

// Stated noise of the readings, one standard deviation; 0: not stated.
struct LightNoise {
  double irradiance_W_m2 = 0.0, relative = 0.0;
  double voltage_V = 0.0, current_A = 0.0;
  std::optional<double> tracker_step_V;
};

// Tabulated irradiance of a lamp on points, which a diagnosis evaluates millions of times.
//
// Let s = d/h be the slope at which a point at distance d from the axis and height h sees the
// middle of the aperture. Then h² times both factors of DiscLight is a smooth function of s that
// hardly depends on (R/h)². It is tabulated by polynomials of degree five in s (even nodes) and in
// (R/h)². They are compared with the quadrature on construction and refined to an error below 1e-6
// of the light on the axis. Beams with edges have kinks and are not tabulated.
class LampTable {
 public:
  // Tabulates heights between these limits; other heights are integrated. Keeps `light`.
  LampTable(std::shared_ptr<const DiscLight> light, double lowest_m, double highest_m);

  // Equals DiscLight::irradiance_W_m2().
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const;
  double radius_m() const { return light_->radius_m(); }

 private:
  static constexpr size_t terms = 6;  // coefficients of the polynomial in (R/h)²
  using Node = std::array<Eigen::Array2d, terms>;

  double place_of(double height_m) const;
  std::vector<Node> nodes_at(double step) const;
  Eigen::Array2d factors(double slope, double height_m) const;
  bool holds() const;

  std::shared_ptr<const DiscLight> light_;
  double lowest_m_, highest_m_;
  double middle_ = 0.0, half_ = 1.0;  // middle and half-width of the range of (R/h)²
  double step_ = 0.0, largest_slope_ = 0.0;
  std::vector<Node> nodes_;  // starts at −2 steps of slope; empty: not tabulated
};

// All lamps with beams of equal relative width.
struct LampSet {
  std::vector<Beam> beams;
  // For each beam; beams of one emitter share an entry.
  std::vector<std::shared_ptr<const DiscLight>> lights;
  std::vector<std::shared_ptr<const LampTable>> tables;
};

// Active area of a cell on the receiver, with a quadrature rule for averages over it.
struct LightCell {
  CellRectangle rectangle;
  double area_m2 = 0.0;
  double photocurrent_factor = 1.0;  // relative to an average cell in equal light
  std::vector<Vec3> points_body_m;
  std::vector<double> weights;  // sum 1
};

class LightLab {
 public:
  // Throws InputError without a flat receiver, or for a lamp without an aperture. `experiment` must
  // outlive this object.
  explicit LightLab(const Experiment& experiment);

  const Experiment& experiment() const { return experiment_; }
  const LightParts& parts() const { return parts_; }
  const SurfaceGrid& grid() const { return *parts_.grid; }
  const std::string& receiver() const { return parts_.receiver; }
  const LightNoise& noise() const { return noise_; }
  const std::vector<LightWall>& walls() const { return parts_.walls; }
  size_t lamps() const { return parts_.lamps; }
  bool has_array() const { return parts_.design.has_value(); }
  const ArrayDesign& design() const { return *parts_.design; }
  const std::vector<LightCell>& cells() const { return cells_; }
  // The model of each cell.
  std::vector<const CellModel*> models() const;
  // The cells' diodes at a temperature, each with an additional leak. `tabulated` is worthwhile if
  // hundreds of points follow.
  CellTables cell_laws(double temperature_K, double leak_S, bool tabulated) const;
  // Photocurrent per light [A/W] at the reference temperature.
  double responsivity_A_W() const { return responsivity_A_W_; }

  // The point of the receiver at map coordinates u, v.
  Vec3 point_body_m(double u_m, double v_m) const;
  Vec3 middle_body_m() const;
  Vec3 normal_body() const { return grid().normal_body; }
  // Width over which the light of the sharpest lamp falls off on the receiver: the standard
  // deviation of a Gaussian spot of equal brightness and maximum slope.
  double narrowest_edge_m() const;

  // The lamps with the widths of all beams multiplied by `divergence` > 0.
  std::shared_ptr<const LampSet> lamps_with(double divergence) const;

  // The state without additional effects.
  LightState nominal() const { return parts_.nominal(); }

 private:
  void read_noise();
  void place_array();
  void place_cells();
  size_t points_of_rule() const;
  void tabulate(LampSet& set) const;

  const Experiment& experiment_;
  LightParts parts_;
  LightNoise noise_;
  std::shared_ptr<const LampSet> lamps_;
  std::vector<LightCell> cells_;
  double responsivity_A_W_ = 0.0;
};

// Keys of the instruments of light and power in [sensors].
std::vector<Key> light_sensor_keys();

}  // namespace photorque
