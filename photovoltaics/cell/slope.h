// Derivatives of a falling current–voltage curve at a point, bounds on them over an interval, and
// how they combine when elements are joined.
#pragma once

#include <algorithm>

namespace photorque {

// y falls with x: `slope` is −dy/dx ≥ 0, `curvature` d²y/dx² and `third` d³y/dx³.
struct Slopes {
  double slope = 0.0, curvature = 0.0, third = 0.0;

  // V(I) of elements in series, I(V) of elements in parallel.
  Slopes& operator+=(const Slopes& other) {
    slope += other.slope;
    curvature += other.curvature;
    third += other.third;
    return *this;
  }
};

// From V(I) to I(V) or back: d³x/dy³ = (3 y″² − y′ y‴)/y′⁵, the others as below. A slope of ∞ (a
// blocked string) becomes 0.
inline Slopes inverted(const Slopes& s) {
  const double inverse = 1.0 / s.slope;
  if (inverse == 0.0) return {};
  const double cube = inverse * inverse * inverse;
  return {inverse, s.curvature * cube,
          -(3.0 * s.curvature * s.curvature * inverse + s.third) * inverse * cube};
}

// y falls with x: `slope` is −dy/dx ≥ 0 and `curvature` is d²y/dx². As V(I) (ohm, V/A²) or as I(V)
// (siemens, A/V²).
struct SlopeRange {
  double slope_low = 0.0, slope_high = 0.0;
  double curvature_low = 0.0, curvature_high = 0.0;

  // V(I) of elements in series, I(V) of elements in parallel.
  SlopeRange& operator+=(const SlopeRange& other) {
    slope_low += other.slope_low;
    slope_high += other.slope_high;
    curvature_low += other.curvature_low;
    curvature_high += other.curvature_high;
    return *this;
  }
  SlopeRange operator*(double copies) const {
    return {copies * slope_low, copies * slope_high, copies * curvature_low,
            copies * curvature_high};
  }
};

// From V(I) to I(V) or back: dx/dy = 1/(dy/dx) and d²x/dy² = −y″/y′³ = y″/slope³.
inline SlopeRange inverted(const SlopeRange& range) {
  const double low = 1.0 / range.slope_high, high = 1.0 / range.slope_low;
  const double low3 = low * low * low, high3 = high * high * high;
  return {low, high, range.curvature_low * (range.curvature_low < 0 ? high3 : low3),
          range.curvature_high * (range.curvature_high > 0 ? high3 : low3)};
}

}  // namespace photorque
