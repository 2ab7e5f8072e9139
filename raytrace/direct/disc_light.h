// Direct light from a uniform aperture on points and surfaces, without rays.
//
// Every point of a disc of area A = πR² radiates with the same intensity per flux f(θ) [1/sr] about
// its axis. A point p lies at height h above the disc's plane and at distance d from its axis.
// Under the angle θ it sees the circle of radius u = h tan θ about its foot; the part of this
// circle on the disc is an arc of half-angle α. Hence the irradiance on a surface of normal n is a
// single integral,
//
//   E = Φ/A ∫ f(θ) (u cos²θ/h²) [2α (−n_z cos θ) − 2 sin α sin θ n·p̂] du,
//
// with p̂ the unit vector from the axis to p's foot. Near the ends of the arc's range α behaves
// like a square root. The substitution u = m − w cos ψ (m = max(R, d), w = min(R, d)) removes it.
//
// The mean irradiance within the circle of radius d about the axis at height h depends only on the
// flux F within an angle. Light under the angle θ is the disc displaced by u. Integrating the
// common area of the two circles over dF by parts gives, with u² = R² + d² − 2Rd cos ω,
//
//   M(h, d) = (2Φ/π²) ∫₀^π F(tan θ = u/h) sin²ω/u² dω.
//
// Vector irradiance in empty space has no divergence, and M d²/2 is its stream function. Hence the
// power on any surface follows from M along its outline:
//
//   P = ½ ∮ M(h, d) (x dy − y dx).
//
// M has kinks at the edges of the beam, d = |R ± h tan θ|, and is smooth between them. Along a
// straight side of a surface the kinks are roots of quadratics.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/numerics/adaptive_quadrature.h"
#include "raytrace/direct/angular_table.h"
#include "raytrace/emitter.h"

namespace photorque {

// Light that arrives at a point of a surface.
struct ArrivingLight {
  double irradiance_W_m2 = 0.0;
  // Sum of the directions of travel (unit vectors), weighted by the irradiance from each. Divided
  // by the speed of light it is the momentum that arrives per area and time.
  Vec3 momentum_W_m2 = Vec3::Zero();
};

// An emitter and its aperture with precomputed tables. Immutable; the emitter must outlive it.
class DiscLight {
 public:
  DiscLight(const Emitter& emitter, UniformAperture aperture);

  // Whether both give the same light in the same directions, to the last digit.
  bool same_as(const DiscLight& other) const {
    return aperture_ == other.aperture_ && angles_ == other.angles_;
  }

  const Emitter& emitter() const { return emitter_; }
  double radius_m() const { return aperture_.radius_m; }
  double exitance_W_m2() const { return aperture_.exitance_W_m2; }
  bool parallel() const;  // whether the aperture is infinite
  // Points at or below this height above the aperture count as behind it.
  double lowest_m() const { return 1e-9 * aperture_.radius_m; }
  // Requires !collimated().
  const AngularTable& angles() const { return *angles_; }
  bool collimated() const { return !angles_; }
  // See AngularTable; 0 (false) for collimated light.
  double reach_rad() const { return angles_ ? angles_->reach_rad() : 0.0; }
  double half_flux_rad() const { return angles_ ? angles_->half_flux_rad() : 0.0; }
  bool fades_out() const { return angles_ && angles_->fades_out(); }

  // Unobstructed irradiance [W/m²] at a point of the emitter's frame on a surface of unit normal.
  // Every arriving ray must come from the front side, see lights_front(). Relative error below
  // 1e-7.
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const;

  // Unobstructed light at a point, with its momentum, in the emitter's frame.
  ArrivingLight arriving(const Vec3& point_m, const Vec3& normal) const;

  // Six components of the flow of power and momentum at a height and a distance from the axis: A
  // and B of factors_W_m2(); then the symmetric momentum tensor (times c): axial–axial,
  // axial–radial, radial–radial, azimuthal–azimuthal. Not for parallel light.
  using Flow = Eigen::Array<double, 6, 1>;
  Flow flow_W_m2(double distance_m, double height_m) const;
  // Light that arrives at a point with this flow.
  static ArrivingLight arriving_of(const Flow& flow, const Vec3& point_m, const Vec3& normal);

  // Irradiance A on a surface normal to the axis and B on a surface that faces the axis, at a
  // height and a distance from it: E = −n_z A − n·p̂ B. Not for parallel light.
  Eigen::Array2d factors_W_m2(double distance_m, double height_m) const;

  // Unobstructed power [W] through a flat polygon in the emitter's frame, at any inclination. All
  // rays must pass through the same side. The estimated error is aimed to be below `tolerance_W`
  // (> 0); the value is ≥ 0 within its error. Not for parallel light.
  Integral<double> power_through_W(std::span<const Vec3> polygon_m, double tolerance_W) const;

  // Contribution of one side of the polygon to power_through_W(). Both corners are in front of the
  // aperture. The polygon runs counter-clockwise as seen from the side that the light travels to.
  Integral<double> along_edge_W(const Vec3& from_m, const Vec3& to_m, double tolerance_W) const;

  // Positions on the segment between two points, in (0, 1) and rising, at which the irradiance has
  // a kink: the circle about the axis touches the rim of an edge's light. The list also contains
  // the corresponding positions for the angles at which the beam has fallen slightly, by half, and
  // almost to zero.
  std::vector<double> kinks_along(const Vec3& from_m, const Vec3& to_m) const;
  // Values of t in (0, 1), rising, for which two kinks meet on the line corner + t · across + [0,
  // 1] · along.
  std::vector<double> tangent_lines(const Vec3& corner_m, const Vec3& along_m,
                                    const Vec3& across_m) const;

  // Mean irradiance normal to the axis within the circle of radius `distance_m` about it. The error
  // is aimed to be below `tolerance_W_m2` (> 0). Not for parallel light.
  Integral<double> mean_within_W_m2(double distance_m, double height_m,
                                    double tolerance_W_m2) const;

  // Order of magnitude of the irradiance in the lit region at a height.
  double typical_W_m2(double height_m) const;

  // Whether the beam, except 1e-9 of its flux, meets a surface of this normal from its front.
  bool lights_front(const Vec3& normal) const;

 private:
  std::vector<double> hard_slopes() const;  // tangents of the beam's edges
  // tangents of the edges and of the other angles of kinks_along()
  std::vector<double> all_slopes() const;
  std::vector<double> kinks_at(std::span<const double> slopes, const Vec3& from_m,
                               const Vec3& to_m) const;
  double typical_per_exitance(double height_m) const;
  struct Arc;
  template <typename Density>
  auto over_aperture(double distance_m, double height_m, const Density& density) const;

  const Emitter& emitter_;
  UniformAperture aperture_;
  std::optional<AngularTable> angles_;
  double parallel_irradiance_W_m2_ = 0.0;  // on a plane normal to the axis; 0 if not parallel
};

}  // namespace photorque
