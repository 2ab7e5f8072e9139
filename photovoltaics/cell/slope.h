// Derivatives of a falling current–voltage curve at a point, bounds on them over an interval, and
// how they combine when elements are joined.
#pragma once

#include <algorithm>
#include <type_traits>

namespace photorque {

// y falls with x: `slope` is −dy/dx ≥ 0, `curvature` d²y/dx² and `third` d³y/dx³; of one curve, or
// of several in lanes.
template <class T>
struct SlopesOf {
  T slope{}, curvature{}, third{};

  // V(I) of elements in series, I(V) of elements in parallel.
  SlopesOf& operator+=(const SlopesOf& other) {
    slope += other.slope;
    curvature += other.curvature;
    third += other.third;
    return *this;
  }
};

using Slopes = SlopesOf<double>;

// From V(I) to I(V) or back: d³x/dy³ = (3 y″² − y′ y‴)/y′⁵, the others as below. A slope of ∞ (a
// blocked string; none is in lanes) becomes 0.
template <class T>
SlopesOf<T> inverted(const SlopesOf<T>& s) {
  const T inverse = 1.0 / s.slope;
  if constexpr (std::is_same_v<T, double>) {
    if (inverse == 0.0) return {};
  }
  const T cube = inverse * inverse * inverse;
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
