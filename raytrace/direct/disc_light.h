// Light from a uniform aperture straight onto a point, without rays.
//
// Every point of a disc of area A shines with the same intensity per flux f(θ) [1/sr] about its
// axis. A point p at height h above the disc's plane and distance d from its axis sees, under the
// angle θ, the circle of radius u = h tan θ about its foot; the part of it on the disc is an arc of
// half-angle α, cos α = (u² + d² − R²)/(2ud). Hence the irradiance on a surface of normal n is a
// single integral,
//
//   E = Φ/A ∫ f(θ) (u cos²θ/h²) [2α (−n_z cos θ) − 2 sin α sin θ n·p̂] du,
//
// with p̂ the unit vector from the axis to p's foot. Near the ends of the arc's range α goes like a
// square root, which u = m − w cos ψ takes out, so that Gauss–Legendre rules converge fast. A disc
// that is small against the width of a beam without edges needs no more than twelve of its points.
#pragma once

#include <algorithm>
#include <vector>

#include "raytrace/emitter.h"

namespace photorque {

// An emitter with its aperture, made ready. Immutable; must not outlive the emitter.
class DiscLight {
 public:
  DiscLight(const Emitter& emitter, UniformAperture aperture);

  const Emitter& emitter() const { return emitter_; }
  double radius_m() const { return aperture_.radius_m; }
  double exitance_W_m2() const { return aperture_.exitance_W_m2; }
  bool parallel() const;  // an infinite aperture
  // The intensity has no jump, also not where it ends.
  bool fades_out() const { return fades_out_; }

  // Irradiance [W/m²] at a point of the emitter's frame on a surface of unit normal, nothing in
  // between. Every ray that arrives must come from the front side, see lights_front(). Relative
  // error below 1e-5 where it is not far below its maximum.
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const;

  // True when every ray of the beam meets a surface of this normal from its front.
  bool lights_front(const Vec3& normal) const;

  // Intensity per flux [1/sr] at 1 − cos θ = `rise`; zero beyond the last edge. Interpolated to
  // 1e-6 of its maximum.
  double intensity_per_flux(double rise) const {
    for (const Segment& segment : segments_) {
      if (rise <= segment.high) return segment.at((rise - segment.low) * segment.per_step);
    }
    return 0.0;
  }

  // Tangents of the angles where the intensity jumps or changes its law, or hardly any light is
  // left; rising, infinite for a right angle.
  const std::vector<double>& edge_slopes() const { return edge_slopes_; }
  // Half-angle beyond which less than 1e-9 of the flux goes.
  double reach_rad() const { return reach_rad_; }
  // Half-angle that holds half of the flux.
  double half_flux_rad() const { return half_flux_rad_; }

 private:
  // f on [low, high] of the rise, at even steps.
  struct Segment {
    double low, high, per_step;
    std::vector<double> value;

    // The cubic through the four nearest values; `place` in steps.
    double at(double place) const {
      const auto last = static_cast<int>(value.size()) - 3;
      const int first = std::clamp(static_cast<int>(place), 1, last);
      const double t = place - first;
      const double* v = value.data() + first;
      const double left = t + 1.0, right = t - 1.0, far = t - 2.0;
      return 0.5 * left * far * (right * v[0] - t * v[1]) +
             (1.0 / 6.0) * t * right * (left * v[2] - far * v[-1]);
    }
  };
  void tabulate();
  void find_angles();
  double from_small_disc(const Vec3& point_m, const Vec3& normal) const;
  double integrand(double u_m, double height_m, double half_arc, double sine_arc,
                   double normal_axis, double normal_away) const;

  const Emitter& emitter_;
  UniformAperture aperture_;
  std::vector<Segment> segments_;
  std::vector<double> edge_slopes_;
  double reach_rad_ = 0.0;
  double half_flux_rad_ = 0.0;
  double half_flux_slope_ = 0.0;  // its tangent, at most 14
  bool fades_out_ = false;
  double parallel_irradiance_W_m2_ = 0.0;  // of parallel light on a plane normal to the axis
};

}  // namespace photorque
