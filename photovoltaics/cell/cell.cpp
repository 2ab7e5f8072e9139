#include "photovoltaics/cell/cell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/root.h"
#include "core/text/format.h"

namespace photorque {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = std::numeric_limits<double>::epsilon();

void check(const CellParameters& p) {
  const auto require = [](bool good, const char* key, double found, const char* expected) {
    if (!good) throw InputError({}, key, std::to_string(found), expected);
  };
  const auto positive = [&](const char* key, double x) {
    require(std::isfinite(x) && x > 0, key, x, "a number > 0");
  };
  const auto not_negative = [&](const char* key, double x) {
    require(std::isfinite(x) && x >= 0, key, x, "a number >= 0");
  };
  not_negative("saturation_1_A", p.saturation_1_A);
  not_negative("saturation_2_A", p.saturation_2_A);
  if (!(p.saturation_1_A + p.saturation_2_A > 0)) {
    // The saturation currents of very cold cells are below the smallest double.
    throw InputError(
        {}, "saturation_1_A", printed("zero saturation currents at %.3g K", p.temperature_K),
        "saturation_1_A or saturation_2_A > 0, or a higher temperature_K of the cells");
  }
  positive("ideality_1", p.ideality_1);
  positive("ideality_2", p.ideality_2);
  not_negative("series_ohm", p.series_ohm);
  positive("shunt_ohm", p.shunt_ohm);
  require(p.breakdown_fraction >= 0 && p.breakdown_fraction <= 7, "breakdown_fraction",
          p.breakdown_fraction, "a number in [0, 7]");
  require(std::isfinite(p.breakdown_V) && p.breakdown_V < 0, "breakdown_V", p.breakdown_V,
          "a number < 0");
  require(std::isfinite(p.breakdown_exponent) && p.breakdown_exponent >= 1, "breakdown_exponent",
          p.breakdown_exponent, "a number >= 1");
  positive("temperature_K", p.temperature_K);
  not_negative("shunt_photocurrent_A", p.shunt_light_A);
  require(p.shunt_dark_ohm > 0, "shunt_dark_ohm", p.shunt_dark_ohm, "a number > 0");
  positive("shunt_exponent", p.shunt_exponent);
}

// The voltage at which one diode alone carries `current_A` (> 0); ∞ without that diode.
double forward_inverse(double current_A, double saturation_A, double scale_V) {
  return saturation_A > 0 ? scale_V * std::log1p(current_A / saturation_A) : infinity;
}

// The magnitude of the reverse voltage at which one diode alone carries the reverse current
// `current_A` (> 0); ∞ if the current exceeds the saturation current.
double reverse_inverse(double current_A, double saturation_A, double scale_V) {
  return current_A < saturation_A ? -scale_V * std::log1p(-current_A / saturation_A) : infinity;
}

}  // namespace

CellParameters in_light(CellParameters p, double photocurrent_A) {
  if (p.shunt_light_A == 0.0) return p;
  const double x = std::max(0.0, photocurrent_A) / p.shunt_light_A;
  double ohm = p.shunt_ohm / x;
  if (std::isfinite(p.shunt_dark_ohm)) {
    const double full = std::exp(-p.shunt_exponent);
    const double base_ohm = std::max(0.0, (p.shunt_ohm - p.shunt_dark_ohm * full) / (1.0 - full));
    ohm = base_ohm + (p.shunt_dark_ohm - base_ohm) * std::exp(-p.shunt_exponent * x);
  }
  // In the dark the shunt is nearly infinite; its factor is limited, and the breakdown fraction
  // remains in its valid range.
  constexpr double most = 1e9, most_fraction = 6.9;
  double times = std::clamp(ohm / p.shunt_ohm, 1.0 / most, most);
  if (p.breakdown_fraction > 0.0) {
    times = std::min(times, std::max(1.0, most_fraction / p.breakdown_fraction));
  }
  p.shunt_ohm *= times;
  p.breakdown_fraction *= times;
  p.shunt_light_A = 0.0;
  return p;
}

CellCurve::CellCurve(const CellParameters& parameters)
    : parameters_(parameters),
      thermal_V_(boltzmann_J_K * parameters.temperature_K / elementary_charge_C),
      scale_1_V_(parameters.ideality_1 * thermal_V_),
      scale_2_V_(parameters.ideality_2 * thermal_V_),
      shunt_S_(1.0 / parameters.shunt_ohm),
      breakdown_S_(parameters.breakdown_fraction / parameters.shunt_ohm),
      breakdown_size_V_(-parameters.breakdown_V) {
  check(parameters);
}

DarkCurrent CellCurve::dark(double diode_V) const {
  const double i1 = parameters_.saturation_1_A, i2 = parameters_.saturation_2_A;
  const double e1 = std::expm1(diode_V / scale_1_V_);
  const double g1 = i1 * (e1 + 1.0) / scale_1_V_;
  DarkCurrent d{i1 * e1 + shunt_S_ * diode_V, g1 + shunt_S_, g1 / scale_1_V_,
                g1 / (scale_1_V_ * scale_1_V_)};
  if (i2 > 0) {
    const double e2 = std::expm1(diode_V / scale_2_V_);
    const double g2 = i2 * (e2 + 1.0) / scale_2_V_;
    d.value_A += i2 * e2;
    d.slope_S += g2;
    d.curvature_A_V2 += g2 / scale_2_V_;
    d.third_A_V3 += g2 / (scale_2_V_ * scale_2_V_);
  }
  if (breakdown_S_ > 0) {
    const double m = parameters_.breakdown_exponent;
    const double y = 1.0 + diode_V / breakdown_size_V_;
    const double multiplied_S = breakdown_S_ * std::pow(y, -m);
    d.value_A += multiplied_S * diode_V;
    d.slope_S += multiplied_S * (1.0 - m + m / y);
    d.curvature_A_V2 +=
        multiplied_S * m * ((m - 1.0) * y - (m + 1.0)) / (y * y * breakdown_size_V_);
    d.third_A_V3 += multiplied_S * m * (m + 1.0) * ((m + 2.0) - (m - 1.0) * y) /
                    (y * y * y * breakdown_size_V_ * breakdown_size_V_);
  }
  return d;
}

// Each term alone needs at least the voltage of the sum to carry the whole current: an upper bound.
// At least one of the n terms carries 1/n of the current: a lower bound.
CellCurve::Bracket CellCurve::forward_bracket(double dark_A, double conductance_S) const {
  const auto smallest = [&](double term_A, double linear_S) {
    return std::min({forward_inverse(term_A, parameters_.saturation_1_A, scale_1_V_),
                     forward_inverse(term_A, parameters_.saturation_2_A, scale_2_V_),
                     term_A / linear_S});
  };
  // For forward voltages, the breakdown factor is below 1.
  return {smallest(dark_A / 3.0, conductance_S + breakdown_S_), smallest(dark_A, conductance_S)};
}

CellCurve::Bracket CellCurve::reverse_bracket(double dark_A, double conductance_S) const {
  const double size_A = -dark_A, term_A = size_A / 4.0, half_V = 0.5 * breakdown_size_V_;
  const double m = parameters_.breakdown_exponent;
  double farthest = size_A / conductance_S;
  double nearest = std::min({reverse_inverse(term_A, parameters_.saturation_1_A, scale_1_V_),
                             reverse_inverse(term_A, parameters_.saturation_2_A, scale_2_V_),
                             term_A / conductance_S});
  if (breakdown_S_ > 0) {
    // Bounds of the breakdown current: beyond V_br/2, V_d is between V_br/2 and V_br; below V_br/2,
    // the factor (1 − V_d/V_br)^−m is between 1 and 2^m.
    const double far_y = std::pow(half_V * breakdown_S_ / size_A, 1.0 / m);
    farthest = std::min(farthest, std::max(half_V, breakdown_size_V_ * (1.0 - far_y)));
    const double near_y = std::pow(breakdown_size_V_ * breakdown_S_ / term_A, 1.0 / m);
    const double near = near_y < 0.5 ? breakdown_size_V_ * (1.0 - near_y)
                                     : std::min(half_V, term_A / (breakdown_S_ * std::exp2(m)));
    nearest = std::min(nearest, near);
  }
  return {-farthest, -nearest};
}

double CellCurve::diode_voltage_V(double dark_A, double extra_S) const {
  if (dark_A == 0.0) return 0.0;
  const double linear_S = shunt_S_ + extra_S;
  auto [low, high] =
      dark_A > 0 ? forward_bracket(dark_A, linear_S) : reverse_bracket(dark_A, linear_S);
  // Because of rounding, the root may be outside by a few units in the last place.
  low -= 4 * rounding * std::abs(low);
  high += 4 * rounding * std::abs(high);
  double v = dark_A > 0 ? high : low;
  if (breakdown_S_ > 0) v = std::max(v, -breakdown_size_V_ * (1.0 - rounding));
  // Newton steps on log(D/j), which is nearly linear in V_d for exponentials and in log V_d for
  // powers.
  return newton_root(low, high, v, 4 * rounding, [&](double trial_V) {
    DarkCurrent d = dark(trial_V);
    d.value_A += extra_S * trial_V;
    d.slope_S += extra_S;
    const double excess = (d.value_A - dark_A) / dark_A;
    return NewtonStep{!(d.value_A > dark_A), -std::log1p(excess) * d.value_A / d.slope_S};
  });
}

double CellCurve::voltage_V(double photocurrent_A, double current_A) const {
  return diode_voltage_V(photocurrent_A - current_A) - current_A * parameters_.series_ohm;
}

double CellCurve::current_A(double photocurrent_A, double voltage_V) const {
  // V_d + D R_s = V + I_L R_s: eq. 2 with an additional shunt conductance 1/R_s.
  const double rs = parameters_.series_ohm;
  if (rs == 0.0) return photocurrent_A - dark(voltage_V).value_A;
  const double diode_V = diode_voltage_V(photocurrent_A + voltage_V / rs, 1.0 / rs);
  const DarkCurrent d = dark(diode_V);
  // Two explicit forms of eq. 1 give the current; this one amplifies the rounding of V_d less.
  return d.slope_S * rs > 1.0 ? (diode_V - voltage_V) / rs : photocurrent_A - d.value_A;
}

double CellCurve::photocurrent_A(double short_circuit_A) const {
  return short_circuit_A + dark(short_circuit_A * parameters_.series_ohm).value_A;
}

CellOperatingPoint CellCurve::maximum_power(double photocurrent_A) const {
  if (photocurrent_A <= 0.0) return {};
  const double rs = parameters_.series_ohm;
  // dP/dV_d = I − D′ (V_d − 2 I R_s) decreases through zero between short and open circuit.
  const double low = short_circuit_A(photocurrent_A) * rs;
  const double high = open_circuit_V(photocurrent_A);
  double v = std::max(low, high - 3.0 * std::max(scale_1_V_, scale_2_V_));
  if (!(v > low)) v = std::midpoint(low, high);
  v = newton_root(low, high, v, 4 * rounding, [&](double trial_V) {
    const DarkCurrent d = dark(trial_V);
    const double current = photocurrent_A - d.value_A;
    const double arm_V = trial_V - 2.0 * current * rs;
    const double slope = current - d.slope_S * arm_V;
    const double curvature = -d.slope_S * (2.0 + 2.0 * d.slope_S * rs) - d.curvature_A_V2 * arm_V;
    return NewtonStep{slope > 0.0, -slope / curvature};
  });
  const double current = photocurrent_A - dark(v).value_A;
  return {v - current * rs, current, v};
}

}  // namespace photorque
