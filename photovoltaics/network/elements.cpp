#include "photovoltaics/network/elements.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
double extrapolated_A(const ElementPoint& at, double current_A, double voltage_V) {
  const Slopes current = inverted(at.slopes());
  const double h = voltage_V - at.voltage_V;
  const double growth = current.curvature != 0.0 ? h * current.third / current.curvature : 0.0;
  const double bend = std::abs(growth) > 1e-3 && std::abs(growth) < 30.0
                          ? (std::expm1(growth) - growth) / (growth * growth)
                          : 0.5 + growth / 6.0;
  return current_A - h * (current.slope - h * current.curvature * bend);
}

DiodeJunction::DiodeJunction(const Diode& diode)
    : kind(diode.kind),
      drop_V(diode.drop_V),
      saturation_A(diode.saturation_A),
      series_ohm(diode.series_ohm),
      scale_V(diode.ideality * boltzmann_J_K * diode.temperature_K / elementary_charge_C),
      per_scale_1_V(1.0 / scale_V) {}

double DiodeJunction::current_A(double junction_voltage_V) const {
  return saturation_A * std::expm1(junction_voltage_V * per_scale_1_V);
}

// Newton's method for u + i(u) R_s = V, which is convex: iterates decrease towards the root. From a
// start below the root the first step leads above it.
double DiodeJunction::junction_V(double forward_V) const {
  if (forward_V <= saturated_V()) return forward_V + saturation_A * series_ohm;
  double u = forward_V;
  if (forward_V > 0.0 && series_ohm > 0.0) {
    u = std::min(u, scale_V * std::log1p(forward_V / (saturation_A * series_ohm)));
  }
  constexpr int max_rounds = 60;
  for (int round = 0; round < max_rounds; ++round) {
    const double through_A = current_A(u);
    const double step =
        (u + through_A * series_ohm - forward_V) / (1.0 + conductance_S(through_A) * series_ohm);
    u -= step;
    // The remaining error is of second order in the step over n V_t.
    if (std::abs(step) <= 1e-9 * scale_V) break;
  }
  return u;
}

double DiodeJunction::slope_S(double g) const {
  return g / (1.0 + g * series_ohm);
}

double DiodeJunction::curvature_A_V2(double g) const {
  const double divisor = 1.0 + g * series_ohm;
  return g / (scale_V * divisor * divisor * divisor);
}

// With w the forward voltage, w(i) = n V_t ln(1 + i/I_s) + i R_s; the substring's V is −w.
Slopes DiodeJunction::slopes(double g) const {
  const double divisor = 1.0 + g * series_ohm, per_divisor = 1.0 / divisor;
  const double per_divisor3 = per_divisor * per_divisor * per_divisor;
  const double bend = g * per_scale_1_V * per_divisor3;
  return {g * per_divisor, bend,
          -bend * per_scale_1_V * (1.0 - 2.0 * g * series_ohm) * per_divisor * per_divisor};
}

// The slope rises with g; the curvature has one maximum, at g R_s = 1/2.
SlopeRange DiodeJunction::range(double low_S, double high_S) const {
  const double a = curvature_A_V2(low_S), b = curvature_A_V2(high_S);
  const double peak_S = 0.5 / std::max(series_ohm, 1e-30);
  const bool inside = low_S < peak_S && peak_S < high_S;
  return {slope_S(low_S), slope_S(high_S), std::min(a, b),
          inside ? curvature_A_V2(peak_S) : std::max(a, b)};
}

}  // namespace photorque
