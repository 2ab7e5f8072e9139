// A solar cell as a lumped circuit: photocurrent, one or two diodes, shunt with reverse breakdown,
// series resistance.
//
//   I = I_L − D(V_d),   V = V_d − I R_s,                                                      (1)
//   D(V_d) = I₁ (e^{V_d/n₁V_t} − 1) + I₂ (e^{V_d/n₂V_t} − 1)
//            + V_d/R_sh · (1 + a (1 − V_d/V_br)^{−m}),   V_t = kT/q.                           (2)
//
// I and V are explicit functions of the diode voltage V_d; all results are found by a search for
// V_d. D rises strictly on (V_br, ∞) for a < e² (the steepest fall of the last term is
// ((m−1)/(m+1))^{m+1} a/R_sh < e⁻² a/R_sh). Every search therefore has one root. It is bracketed
// from both sides by the inverses of the single terms of (2), so the search always converges.
//
// Currents leave the cell at its positive terminal; a reverse-biased cell has V < 0. A whole module
// of N equal cells in series is the same circuit with n, R_s, R_sh, V_br multiplied by N.
//
// Sources: (1)–(2) with a = 0, M. Wolf, H. Rauschenbach, Adv. Energy Conversion 3, 455 (1963);
// breakdown, J. W. Bishop, Solar Cells 25, 73 (1988), eq. 6.
#pragma once

#include <limits>

namespace photorque {

// Parameters at one temperature.
struct CellParameters {
  double saturation_1_A = 1e-12;    // I₁ ≥ 0
  double ideality_1 = 1.0;          // n₁ > 0
  double saturation_2_A = 0.0;      // I₂ ≥ 0; I₁ + I₂ > 0
  double ideality_2 = 2.0;          // n₂ > 0
  double series_ohm = 0.0;          // R_s ≥ 0
  double shunt_ohm = 1e4;           // R_sh > 0, finite
  double breakdown_fraction = 0.0;  // a in [0, 7]; 0: no breakdown
  double breakdown_V = -15.0;       // V_br < 0
  double breakdown_exponent = 3.0;  // m ≥ 1
  double temperature_K = 298.15;    // T > 0
  // The photocurrent at which the shunt is R_sh, if the shunt depends on the light (in_light()); 0:
  // R_sh in any light.
  double shunt_light_A = 0.0;
  // R_sh in the dark of such a shunt; ∞ if it is inversely proportional to the light.
  double shunt_dark_ohm = std::numeric_limits<double>::infinity();
  double shunt_exponent = 5.5;
};

// The circuit at a photocurrent, with a constant shunt. With x the photocurrent over shunt_light_A,
// R_sh is
//
//   R_sh/x                        without a resistance in the dark: W. De Soto, S. A. Klein, W. A.
//                                 Beckman, Solar Energy 80, 78 (2006), eq. 12; and the CEC model,
//                                 A. P. Dobos, J. Sol. Energy Eng. 134, 021011 (2012)
//   R_b + (R_0 − R_b) e^{−c x}    with R_0 in the dark, c = shunt_exponent, and R_b ≥ 0 such that
//                                 R_sh holds at x = 1: A. Mermoud, T. Lejeune, 25th EU PVSEC
//                                 (2010), as in PVsyst
//
// The breakdown current is unchanged.
CellParameters in_light(CellParameters parameters, double photocurrent_A);

// D of eq. 2 and its derivatives by V_d.
struct DarkCurrent {
  double value_A = 0.0;
  double slope_S = 0.0;  // > 0
  double curvature_A_V2 = 0.0;
  double third_A_V3 = 0.0;
};

struct CellOperatingPoint {
  double voltage_V = 0.0;
  double current_A = 0.0;
  double diode_V = 0.0;
  double power_W() const { return voltage_V * current_A; }
};

// The circuit, prepared for evaluation. Accuracy of all results: a few units of rounding of the
// largest term in (1) and (2), which is about 1e-15 of I_L and of V_d.
class CellCurve {
 public:
  // Throws InputError for parameters out of the ranges above.
  explicit CellCurve(const CellParameters& parameters);

  const CellParameters& parameters() const { return parameters_; }
  double thermal_V() const { return thermal_V_; }
  // The smaller of n₁ V_t and n₂ V_t.
  double min_scale_V() const { return scale_1_V_ < scale_2_V_ ? scale_1_V_ : scale_2_V_; }

  // D at a diode voltage > V_br.
  DarkCurrent dark(double diode_V) const;
  // The diode voltage at which D + extra_S·V_d equals a current of either sign. `extra_S` ≥ 0.
  double diode_voltage_V(double dark_A, double extra_S = 0.0) const;

  double voltage_V(double photocurrent_A, double current_A) const;
  double current_A(double photocurrent_A, double voltage_V) const;
  double open_circuit_V(double photocurrent_A) const { return diode_voltage_V(photocurrent_A); }
  double short_circuit_A(double photocurrent_A) const { return current_A(photocurrent_A, 0.0); }
  // The maximum power point; all zero for a photocurrent ≤ 0. It is the only maximum unless the
  // breakdown term carries most of the forward current (a > 1 with |V_br| of a few n V_t).
  CellOperatingPoint maximum_power(double photocurrent_A) const;
  // The photocurrent that gives a short-circuit current.
  double photocurrent_A(double short_circuit_A) const;

 private:
  struct Bracket {
    double low_V, high_V;
  };
  Bracket forward_bracket(double dark_A, double conductance_S) const;
  Bracket reverse_bracket(double dark_A, double conductance_S) const;

  CellParameters parameters_;
  double thermal_V_;
  double scale_1_V_;         // n₁ V_t
  double scale_2_V_;         // n₂ V_t
  double shunt_S_;           // 1/R_sh
  double breakdown_S_;       // a/R_sh
  double breakdown_size_V_;  // |V_br|
};

}  // namespace photorque
