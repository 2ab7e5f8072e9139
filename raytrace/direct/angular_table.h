// Table of a beam over angles: intensity and encircled flux.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/constants.h"
#include "core/numerics/interpolation.h"
#include "raytrace/emitter.h"

namespace photorque {

// Immutable. An angle θ is given as the rise 1 − cos θ or as the slope tan θ.
class AngularTable {
 public:
  // `edges_rad` as in UniformAperture: at least one angle, in rising order, the last one > 0.
  AngularTable(const Emitter& emitter, const std::vector<double>& edges_rad);
  bool operator==(const AngularTable&) const = default;

  // Intensity per flux [1/sr]; zero beyond the last edge. The interpolation error is 1e-7 of the
  // largest intensity between the two neighbouring edges.
  double intensity_per_flux(double rise) const {
    const Segment* segment = segment_at(rise);
    return segment ? segment->intensity(rise) : 0.0;
  }
  // Fraction of the flux within the angle, in [0, 1]: the integral of the intensity.
  double flux_within(double rise) const {
    const Segment* segment = segment_at(rise);
    return segment ? segment->flux(rise) : 1.0;
  }

  // Tangents of the angles where the intensity jumps or changes its formula, and of the angle
  // beyond which hardly any light is left. In rising order; infinite for a right angle.
  const std::vector<double>& edge_slopes() const { return edge_slopes_; }
  // Whether the intensity has no jump, including at its outer end.
  bool fades_out() const { return fades_out_; }
  // Half-angle that contains all but 1e-9 of the flux.
  double reach_rad() const { return reach_rad_; }
  // Half-angle that contains half of the flux.
  double half_flux_rad() const { return half_flux_rad_; }
  // Maximum intensity divided by its steepest slope (jumps excluded); at most half_flux_rad().
  double steepest_rad() const { return steepest_rad_; }
  // Mean cosine over all directions, and mean square of the cosine, both weighted by flux.
  double mean_cosine() const { return mean_cosine_; }
  double mean_square_cosine() const { return mean_square_cosine_; }

 private:
  // Intensity and flux on [low, high] of the rise, at equal steps.
  struct Segment {
    double low, high, per_step;
    std::vector<double> value, within;
    bool operator==(const Segment&) const = default;

    // Cubic through the four nearest values.
    double intensity(double rise) const {
      const double place = (rise - low) * per_step;
      const auto last = static_cast<int>(value.size()) - 3;
      const int first = std::clamp(static_cast<int>(place), 1, last);
      const double t = place - first;
      const double* v = value.data() + first;
      const double left = t + 1.0, right = t - 1.0, far = t - 2.0;
      return 0.5 * left * far * (right * v[0] - t * v[1]) +
             (1.0 / 6.0) * t * right * (left * v[2] - far * v[-1]);
    }
    // Cubic with the values and slopes of the flux at both ends of a step.
    double flux(double rise) const {
      const double place = (rise - low) * per_step;
      const int last = static_cast<int>(value.size()) - 2;
      const int first = std::clamp(static_cast<int>(place), 0, last);
      const double t = place - first;
      const double* v = value.data() + first;
      const double* f = within.data() + first;
      const double slope = flux_per_intensity / per_step;
      const auto c = hermite_coefficients(f[0], f[1] - f[0], slope * v[0], slope * v[1]);
      return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    }
  };
  static constexpr double flux_per_intensity = 2.0 * pi;  // per rise

  const Segment* segment_at(double rise) const {
    for (const Segment& segment : segments_) {
      if (rise < segment.high) return &segment;
    }
    return nullptr;
  }
  void add_segment(const Emitter& emitter, double low_rad, double high_rad, int splits);
  void normalise();
  void find_angles(const std::vector<double>& edges_rad);

  std::vector<Segment> segments_;
  std::vector<double> edge_slopes_;
  bool fades_out_ = false;
  double reach_rad_ = 0.0, half_flux_rad_ = 0.0, steepest_rad_ = 0.0;
  double mean_cosine_ = 0.0, mean_square_cosine_ = 0.0;
};

// 1 − cos θ for tan² θ = `slope_squared`; keeps its relative precision near the axis.
inline double rise_at_slope(double slope_squared) {
  const double secant = std::sqrt(1.0 + slope_squared);
  return slope_squared / (secant * (1.0 + secant));
}

}  // namespace photorque
