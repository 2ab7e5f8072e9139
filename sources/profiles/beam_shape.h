// Beam angles: widths and encircled flux of any emitter, from its relative intensity.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/product.h"
#include "raytrace/emitter.h"

namespace photorque {

// Flux within cones about the axis, by adaptive quadrature of the relative intensity. Resolves
// beams from 1e-8 rad to the whole sphere, edges, and cores with halos; narrower beams count as
// collimated. Error below 1e-8 of the flux.
class EncircledFlux {
 public:
  explicit EncircledFlux(const Emitter& emitter);

  // Fraction of the flux within a half-angle ∈ [0, π], in [0, 1].
  double within(double half_angle_rad) const;

  // Half-angle that contains a fraction ∈ [0, 1] of the flux; 0 for a collimated beam.
  double half_angle_rad(double fraction) const;

  // Flux divided by the maximum intensity [sr]; 0 for a collimated beam.
  double solid_angle_sr() const;

 private:
  struct Panel {
    double low_rad, high_rad;
    double before;  // flux within low_rad
    double flux;
  };
  void refine(double low_rad, double high_rad, double tolerance, int depth);
  double flux_density(double angle_rad) const;  // per radian
  double flux_between(double low_rad, double high_rad) const;
  double flux_within(const Panel& panel, double angle_rad) const;

  const Emitter& emitter_;  // must outlive this
  std::vector<Panel> panels_;
};

// Twice the largest angle at which the intensity is `level` ∈ (0, 1) of its maximum, to 1e-12
// relative; 0 for a collimated beam.
double full_width_rad(const Emitter& emitter, double level);

struct BeamShape {
  double fwhm_rad = 0.0;              // full width at half of the maximum intensity
  double full_width_tenth_rad = 0.0;  // full width at a tenth
  double half_angle_50_rad = 0.0;     // half-angles that hold 50 %,
  double half_angle_86_rad = 0.0;     // 1 − 1/e² = 86.5 % (where a Gaussian falls to 1/e²)
  double half_angle_90_rad = 0.0;     // and 90 % of the flux
  double within_half_fwhm = 0.0;      // fractions of the flux within ±fwhm/2
  double within_fwhm = 0.0;           // and ±fwhm; 1 for a collimated beam
  bool collimated = false;
};
// Widths and encircled flux of an emitter.
BeamShape describe(const Emitter& emitter);

// "lamp: FWHM 3 deg, full width at tenth maximum 5.468 deg; 50 % of the flux within ±1.5 deg, …"
std::string one_line(const std::string& name, const BeamShape& shape);

// One row for each different emitter among the beams: the name of its first beam, the number of
// beams that share it, the power of one beam, and its shape.
Table beam_shape_table(std::span<const Beam> beams);

// Beam shapes as lines of text.
std::vector<std::string> beam_shape_lines(std::span<const Beam> beams);

}  // namespace photorque
