// Two-terminal elements of a string (cells and diodes) at a point of their curves: derivatives,
// bounds on them over an interval, and their combination when elements are joined.
#pragma once

#include <algorithm>
#include <cmath>

#include "photovoltaics/cell/diode_voltage.h"
#include "photovoltaics/network/wiring.h"

namespace photorque {

// Derivatives of a falling current–voltage curve at a point. y falls with x: `slope` is −dy/dx ≥ 0,
// `curvature` d²y/dx² and `third` d³y/dx³.
struct Slopes {
  double slope = 0.0, curvature = 0.0, third = 0.0;

  // Joins elements: V(I) in series, I(V) in parallel.
  Slopes& operator+=(const Slopes& other) {
    slope += other.slope;
    curvature += other.curvature;
    third += other.third;
    return *this;
  }
};

// Converts V(I) into I(V) or back: d³x/dy³ = (3 y″² − y′ y‴)/y′⁵, the others as below. A slope of ∞
// (of a blocked string) becomes 0.
inline Slopes inverted(const Slopes& s) {
  const double inverse = 1.0 / s.slope;
  if (inverse == 0.0) return {};
  const double cube = inverse * inverse * inverse;
  return {inverse, s.curvature * cube,
          -(3.0 * s.curvature * s.curvature * inverse + s.third) * inverse * cube};
}

// Bounds over an interval. y falls with x: `slope` is −dy/dx ≥ 0 and `curvature` is d²y/dx². The
// curve is V(I) (ohm, V/A²) or I(V) (siemens, A/V²).
struct SlopeRange {
  double slope_low = 0.0, slope_high = 0.0;
  double curvature_low = 0.0, curvature_high = 0.0;

  // Joins elements: V(I) in series, I(V) in parallel.
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

// Converts V(I) into I(V) or back: dx/dy = 1/(dy/dx) and d²x/dy² = −y″/y′³ = y″/slope³.
inline SlopeRange inverted(const SlopeRange& range) {
  const double low = 1.0 / range.slope_high, high = 1.0 / range.slope_low;
  const double low3 = low * low * low, high3 = high * high * high;
  return {low, high, range.curvature_low * (range.curvature_low < 0 ? high3 : low3),
          range.curvature_high * (range.curvature_high > 0 ? high3 : low3)};
}

// `copies` equal cells in series; 1 for a cell in parallel with others.
struct LitCell {
  const DiodeVoltageLaw* law = nullptr;
  double photocurrent_A = 0.0;
  double series_ohm = 0.0;
  double copies = 1.0;
  double offset_V = 0.0;  // added to the voltage of each cell
};

// A two-terminal element at a current.
struct ElementPoint {
  double voltage_V = 0.0;
  double slope_ohm = 0.0;       // −dV/dI ≥ 0
  double curvature_V_A2 = 0.0;  // d²V/dI²
  double third_V_A3 = 0.0;      // d³V/dI³

  // Joins elements in series.
  ElementPoint& operator+=(const ElementPoint& other) {
    voltage_V += other.voltage_V;
    slope_ohm += other.slope_ohm;
    curvature_V_A2 += other.curvature_V_A2;
    third_V_A3 += other.third_V_A3;
    return *this;
  }
  Slopes slopes() const { return {slope_ohm, curvature_V_A2, third_V_A3}; }
};

// V(I) of elements in parallel at their common voltage, from the sum of their I(V).
inline ElementPoint tied_point(double voltage_V, const Slopes& current) {
  const Slopes voltage = inverted(current);
  return {voltage_V, voltage.slope, voltage.curvature, voltage.third};
}

// One cell at a current of either sign.
inline ElementPoint cell_at(const LitCell& cell, double current_A, JunctionState& state) {
  const DiodeVoltage v = cell.law->at(cell.photocurrent_A - current_A);
  state = {v.slope_ohm, v.curvature_V_A2};
  return {v.value_V + cell.offset_V - current_A * cell.series_ohm, v.slope_ohm + cell.series_ohm,
          v.curvature_V_A2, -v.third_V_A3};
}

// Bounds on V(I) of one cell between two states; `high_v` at the higher diode voltage.
//
// With r = dV_d/dj = 1/D′ the curvature is −D″ r³, and D″ is monotone: over the interval it lies
// between −D″(high_v) r³ and −D″(low_v) r³ for some r of the interval.
inline SlopeRange cell_range(const LitCell& cell, const JunctionState& high_v,
                             const JunctionState& low_v) {
  const double low = std::min(high_v.slope_ohm, low_v.slope_ohm);
  const double high = high_v.curvature_V_A2 < 0 && low_v.curvature_V_A2 > 0
                          ? cell.law->largest_slope_ohm()
                          : std::max(high_v.slope_ohm, low_v.slope_ohm);
  const double min_r = (high_v.curvature_V_A2 < 0 ? high : low) / high_v.slope_ohm;
  const double max_r = (low_v.curvature_V_A2 > 0 ? high : low) / low_v.slope_ohm;
  return {low + cell.series_ohm, high + cell.series_ohm,
          high_v.curvature_V_A2 * min_r * min_r * min_r,
          low_v.curvature_V_A2 * max_r * max_r * max_r};
}

// Extrapolates I(V) from a point of V(I) and its derivatives there, as the sum of a straight line
// and an exponential, like a shunt and a diode. Correct to third order for any curve.
double extrapolated_A(const ElementPoint& at, double current_A, double voltage_V);

// Moves `end_A`, one end of a bracket, in steps that grow fourfold while `is_inside(end_A)`; the
// other end follows. Shunts, breakdown and diodes limit currents to less than 1e6 A.
template <class Predicate>
void widen(double& other_A, double& end_A, double step_A, const Predicate& is_inside) {
  constexpr double most_A = 1e6;
  for (; std::abs(end_A) < most_A && is_inside(end_A); step_A *= 4.0) {
    other_A = end_A;
    end_A += step_A;
  }
}

// For a junction: with u its voltage without R_s, the current is i = I_s (e^{u/nV_t} − 1) and its
// conductance g = (i + I_s)/nV_t. Forward values are positive.
struct DiodeJunction {
  Diode::Kind kind = Diode::Kind::none;
  double drop_V = 0.0, saturation_A = 0.0, series_ohm = 0.0;
  double scale_V = 0.0, per_scale_1_V = 0.0;  // n V_t and its reciprocal

  explicit DiodeJunction(const Diode& diode);

  // At this reverse voltage the current of the diode is −I_s to within 1e-13.
  double saturated_V() const { return -30.0 * scale_V; }
  // The junction voltage without R_s at the voltage `forward_V` of the diode with R_s, to rounding.
  double junction_V(double forward_V) const;
  double current_A(double junction_voltage_V) const;
  double conductance_S(double through_A) const {
    return (through_A + saturation_A) * per_scale_1_V;
  }

  // I(V) with the series resistance, as a function of the junction's conductance. V is the reverse
  // voltage: that of the cells in parallel with a bypass diode.
  Slopes slopes(double conductance_S) const;
  // Bounds between two conductances.
  SlopeRange range(double low_S, double high_S) const;

 private:
  double slope_S(double conductance_S) const;
  double curvature_A_V2(double conductance_S) const;
};

}  // namespace photorque
