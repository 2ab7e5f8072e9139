// Light from a uniform aperture straight onto points and surfaces, without rays.
//
// Every point of a disc of area A = πR² shines with the same intensity per flux f(θ) [1/sr] about
// its axis. A point p at height h above the disc's plane and distance d from its axis sees, under
// the angle θ, the circle of radius u = h tan θ about its foot; the part of it on the disc is an
// arc of half-angle α. Hence the irradiance on a surface of normal n is a single integral,
//
//   E = Φ/A ∫ f(θ) (u cos²θ/h²) [2α (−n_z cos θ) − 2 sin α sin θ n·p̂] du,
//
// with p̂ the unit vector from the axis to p's foot. Near the ends of the arc's range α goes like a
// square root, which u = m − w cos ψ (m = max(R, d), w = min(R, d)) takes out.
//
// The mean irradiance within the circle of radius d about the axis at height h needs only the flux
// F within an angle: light under the angle θ is the disc displaced by u, and the integral by parts
// of the area that two circles share over dF leaves, with u² = R² + d² − 2Rd cos ω,
//
//   M(h, d) = (2Φ/π²) ∫₀^π F(tan θ = u/h) sin²ω/u² dω.
//
// Vector irradiance in empty space has no divergence and M d²/2 is its stream function, so that the
// power on any surface follows from M along its outline alone:
//
//   P = ½ ∮ M(h, d) (x dy − y dx).
//
// Edges of the beam are kinks of M, at d = |R ± h tan θ|, which a straight side of a surface meets
// at the roots of quadratics: the function between them is smooth.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/numerics/adaptive_quadrature.h"
#include "raytrace/direct/angular_table.h"
#include "raytrace/emitter.h"

namespace photorque {

// The light that arrives at a point of a surface.
struct ArrivingLight {
  double irradiance_W_m2 = 0.0;
  // Its directions (unit vectors of travel), weighed by the irradiance that each brings. Over the
  // speed of light: the momentum that arrives per area and time.
  Vec3 momentum_W_m2 = Vec3::Zero();
};

// An emitter with its aperture, made ready. Immutable; must not outlive the emitter.
class DiscLight {
 public:
  DiscLight(const Emitter& emitter, UniformAperture aperture);

  // Gives the same light in the same directions, to all digits.
  bool same_as(const DiscLight& other) const {
    return aperture_ == other.aperture_ && angles_ == other.angles_;
  }

  const Emitter& emitter() const { return emitter_; }
  double radius_m() const { return aperture_.radius_m; }
  double exitance_W_m2() const { return aperture_.exitance_W_m2; }
  bool parallel() const;  // an infinite aperture
  // Points not higher than this above the aperture count as behind it.
  double lowest_m() const { return 1e-9 * aperture_.radius_m; }
  // Only if not collimated.
  const AngularTable& angles() const { return *angles_; }
  bool collimated() const { return !angles_; }
  // As AngularTable; 0 for collimated light.
  double reach_rad() const { return angles_ ? angles_->reach_rad() : 0.0; }
  double half_flux_rad() const { return angles_ ? angles_->half_flux_rad() : 0.0; }
  bool fades_out() const { return angles_ && angles_->fades_out(); }

  // Irradiance [W/m²] at a point of the emitter's frame on a surface of unit normal, nothing in
  // between. Every ray that arrives must come from the front side, see lights_front(). Relative
  // error below 1e-7.
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const;

  // The arriving light with its momentum, in the emitter's frame.
  ArrivingLight arriving(const Vec3& point_m, const Vec3& normal) const;

  // The six components of the flow of power and momentum at a height and a distance from the axis:
  // A and B as of factors_W_m2(), then of the symmetric flow of momentum (times c) along the axis,
  // between axis and away from it, away from it, and around it. Not for parallel light.
  using Flow = Eigen::Array<double, 6, 1>;
  Flow flow_W_m2(double distance_m, double height_m) const;
  // The light that arrives at a point with this flow.
  static ArrivingLight arriving_of(const Flow& flow, const Vec3& point_m, const Vec3& normal);

  // The irradiances A on a surface normal to the axis and B on one that looks at the axis, at a
  // height and a distance from it, such that E = −n_z A − n·p̂ B. Not for parallel light.
  Eigen::Array2d factors_W_m2(double distance_m, double height_m) const;

  // Power through a flat polygon in the emitter's frame at any inclination, nothing in between,
  // every ray through the same side; ≥ 0 but for the error, which is estimated and aimed to be
  // below `tolerance_W` (> 0). Not for parallel light.
  Integral<double> power_through_W(std::span<const Vec3> polygon_m, double tolerance_W) const;

  // The contribution of a side from one corner to the next to such a power, both in front of the
  // aperture; counted against the clock as seen from where the light goes.
  Integral<double> along_edge_W(const Vec3& from_m, const Vec3& to_m, double tolerance_W) const;

  // Fractions of the way between two points at which the irradiance has a kink, where the circle
  // about the axis touches the rim of an edge's light; rising, in (0, 1). With them places that lie
  // likewise to angles at which the beam has fallen a little, by half, and almost altogether.
  std::vector<double> kinks_along(const Vec3& from_m, const Vec3& to_m) const;
  // The t in (0, 1), rising, of the lines corner + t · across + [0, 1] · along at which two kinks
  // meet.
  std::vector<double> tangent_lines(const Vec3& corner_m, const Vec3& along_m,
                                    const Vec3& across_m) const;

  // Mean irradiance normal to the axis within the circle of radius d = `distance_m` about it. With
  // an error aimed to be below `tolerance_W_m2` (> 0). Not for parallel light.
  Integral<double> mean_within_W_m2(double distance_m, double height_m,
                                    double tolerance_W_m2) const;

  // The order of magnitude of the irradiance at a height where there is light.
  double typical_W_m2(double height_m) const;

  // True when every ray of the beam meets a surface of this normal from its front (all but 1e-9 of
  // the flux).
  bool lights_front(const Vec3& normal) const;

 private:
  std::vector<double> hard_slopes() const;  // tangents of its edges
  std::vector<double> all_slopes() const;   // and of other angles, see kinks_along()
  std::vector<double> kinks_at(std::span<const double> slopes, const Vec3& from_m,
                               const Vec3& to_m) const;
  double typical_per_exitance(double height_m) const;
  struct Arc;
  template <typename Density>
  auto over_aperture(double distance_m, double height_m, const Density& density) const;

  const Emitter& emitter_;
  UniformAperture aperture_;
  std::optional<AngularTable> angles_;
  double parallel_irradiance_W_m2_ = 0.0;  // of parallel light on a plane normal to the axis
};

}  // namespace photorque
