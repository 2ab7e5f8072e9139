// The diode voltage of a cell as a function of its dark current.
//
// Equal cells in different light differ only in I_L, and V_d depends on I_L − I alone. One function
// of one variable, j ↦ V_d with D(V_d) = j (cell.h, eq. 2), therefore serves every cell of an array
// in any light. It can be evaluated in three ways with equal results: by solving eq. 2 for every
// point, by a table (table.h), or, for one diode without breakdown, in closed form.
#pragma once

#include <memory>
#include <span>

#include "photovoltaics/cell/cell.h"

namespace photorque {

struct DiodeVoltage {
  double value_V = 0.0;
  double slope_ohm = 0.0;       // dV_d/dj = 1/D′ > 0
  double curvature_V_A2 = 0.0;  // d²V_d/dj²
  double third_V_A3 = 0.0;  // d³V_d/dj³, relative error 1e-3; affects only the speed of solutions
};

// State of one junction at an end of an interval, for bounds over the interval.
struct JunctionState {
  double slope_ohm = 0.0;
  double curvature_V_A2 = 0.0;
};

class DiodeVoltageLaw {
 public:
  explicit DiodeVoltageLaw(const CellCurve& curve) : curve_(curve) {}
  virtual ~DiodeVoltageLaw() = default;

  const CellCurve& curve() const { return curve_; }

  // The diode voltage at a dark current of either sign.
  virtual DiodeVoltage at(double dark_A) const = 0;
  // Sum over cells in series: copies[i] times the voltage of cell i at the dark current
  // photocurrents_A[i] − current_A. `states` receives the states of the single cells. All spans
  // have one length, a multiple of `lanes`.
  static constexpr size_t lanes = 4;
  virtual DiodeVoltage series_at(std::span<const double> photocurrents_A,
                                 std::span<const double> copies, double current_A,
                                 std::span<JunctionState> states) const = 0;
  // The largest slope of the function, at the inflection of D.
  virtual double largest_slope_ohm() const = 0;

 private:
  CellCurve curve_;
};

// Implements series_at() of a law by its at().
template <class Law>
DiodeVoltage series_one_by_one(const Law& law, std::span<const double> photocurrents_A,
                               std::span<const double> copies, double current_A,
                               std::span<JunctionState> states) {
  DiodeVoltage sum;
  for (size_t i = 0; i < photocurrents_A.size(); ++i) {
    if (copies[i] == 0.0) continue;
    const DiodeVoltage v = law.at(photocurrents_A[i] - current_A);
    states[i] = {v.slope_ohm, v.curvature_V_A2};
    sum.value_V += copies[i] * v.value_V;
    sum.slope_ohm += copies[i] * v.slope_ohm;
    sum.curvature_V_A2 += copies[i] * v.curvature_V_A2;
    sum.third_V_A3 += copies[i] * v.third_V_A3;
  }
  return sum;
}

// The diode voltage by a search along eq. 2.
DiodeVoltage solved_diode_voltage(const CellCurve& curve, double dark_A);
// The largest slope of the diode voltage, at the inflection of D, by a search.
double largest_diode_slope_ohm(const CellCurve& curve);

// The solution y of y + e^y = L for any finite L, with an error of 1e-13 of the larger of 1 and
// |y|.
double wright_log_omega(double L);

// A cell of one diode without breakdown. With s = n₁V_t, G = 1/R_sh and a = G s/I₁ the dark current
// at a diode voltage V_d = s (y + ln a) is
//
//   j = I₁ (e^{V_d/s} − 1) + G V_d   if and only if   y + e^y = L,   L = (j + I₁)/(G s) − ln a,
//
// so that y is one function of one number for every cell and temperature: Wright's omega function
// is e^y (R. Corless, D. Jeffrey, Lecture Notes in Computer Science 2385, 76 (2002)). Its
// derivatives are y′ = 1/(1 + e^y), y″ = −e^y y′³, y‴ = e^y (2 e^y − 1) y′⁵. One table therefore
// serves all cells, also in a recording in which every row has a different temperature.
class OneDiode final : public DiodeVoltageLaw {
 public:
  explicit OneDiode(const CellCurve& curve);
  // Whether the parameters have one diode and no breakdown.
  static bool describes(const CellParameters& parameters);

  DiodeVoltage at(double dark_A) const override;
  DiodeVoltage series_at(std::span<const double> photocurrents_A, std::span<const double> copies,
                         double current_A, std::span<JunctionState> states) const override;
  double largest_slope_ohm() const override { return curve().parameters().shunt_ohm; }

 private:
  double saturation_A_, scale_V_, shunt_S_, log_a_, per_A_;
};

// The law that is fastest to construct and evaluate: the closed form if there is one, otherwise a
// table up to currents of `tabulated_A`. If `tabulated_A` is 0, because few points are needed,
// every point is searched.
std::shared_ptr<const DiodeVoltageLaw> diode_voltage_law(const CellParameters& parameters,
                                                         double tabulated_A = 0.0);

// The law of a cell at a photocurrent; `law` itself if its shunt does not depend on the light.
std::shared_ptr<const DiodeVoltageLaw> law_in_light(std::shared_ptr<const DiodeVoltageLaw> law,
                                                    double photocurrent_A);

}  // namespace photorque
