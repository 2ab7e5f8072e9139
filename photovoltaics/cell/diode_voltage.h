// The diode voltage of a cell as a function of its dark current.
//
// Like cells under different light differ only in I_L, and V_d depends on I_L − I alone. One
// function of one variable, j ↦ V_d with D(V_d) = j (cell.h, eq. 2), therefore serves every cell of
// an array, whatever falls on it. Three ways to evaluate it give the same numbers: solve eq. 2 for
// every point, tabulate (table.h), or, for one diode without breakdown, a closed form.
#pragma once

#include <memory>
#include <span>

#include "photovoltaics/cell/cell.h"

namespace photorque {

struct DiodeVoltage {
  double value_V = 0.0;
  double slope_ohm = 0.0;       // dV_d/dj = 1/D′ > 0
  double curvature_V_A2 = 0.0;  // d²V_d/dj²
  double third_V_A3 = 0.0;      // d³V_d/dj³, good to 1e-3 of itself: for the speed of solutions
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

  // At a dark current of either sign.
  virtual DiodeVoltage at(double dark_A) const = 0;
  // The sum over cells in series, copies[i] times that of cell i at the dark current
  // photocurrents_A[i] − current_A; `states` gets those of the single cells. All spans have one
  // length, a multiple of `lanes`.
  static constexpr size_t lanes = 4;
  virtual DiodeVoltage series_at(std::span<const double> photocurrents_A,
                                 std::span<const double> copies, double current_A,
                                 std::span<JunctionState> states) const = 0;
  // The largest slope of the function, at the inflection of D.
  virtual double largest_slope_ohm() const = 0;

 private:
  CellCurve curve_;
};

// series_at() of a law by its at().
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

// By a search along eq. 2 at every point.
DiodeVoltage solved_diode_voltage(const CellCurve& curve, double dark_A);
// At the inflection of D; a search.
double largest_diode_slope_ohm(const CellCurve& curve);

// y + e^y = L for any finite L, to 1e-13 of the larger of 1 and |y|.
double wright_log_omega(double L);

// A cell of one diode without breakdown. With s = n₁V_t, G = 1/R_sh and a = G s/I₁ the dark current
// at a diode voltage V_d = s (y + ln a) is
//
//   j = I₁ (e^{V_d/s} − 1) + G V_d   if and only if   y + e^y = L,   L = (j + I₁)/(G s) − ln a,
//
// so that y is one function of one number, whatever the cell and its temperature: Wright's omega
// function is e^y (R. Corless, D. Jeffrey, Lecture Notes in Computer Science 2385, 76 (2002)). Its
// derivatives follow, y′ = 1/(1 + e^y), y″ = −e^y y′³, y‴ = e^y (2 e^y − 1) y′⁵. One table serves
// all cells, so that a recording in which every row has its own temperature needs no other.
class OneDiode final : public DiodeVoltageLaw {
 public:
  explicit OneDiode(const CellCurve& curve);
  static bool describes(const CellParameters& parameters);

  DiodeVoltage at(double dark_A) const override;
  DiodeVoltage series_at(std::span<const double> photocurrents_A, std::span<const double> copies,
                         double current_A, std::span<JunctionState> states) const override;
  double largest_slope_ohm() const override { return curve().parameters().shunt_ohm; }

 private:
  double saturation_A_, scale_V_, shunt_S_, log_a_, per_A_;
};

// The law that is fastest to make and evaluate: the closed form where there is one; else a table up
// to currents of `tabulated_A`, or, where that is 0 because few points are needed, a search each.
std::shared_ptr<const DiodeVoltageLaw> diode_voltage_law(const CellParameters& parameters,
                                                         double tabulated_A = 0.0);

// The law of a cell under a photocurrent: the same where its shunt does not change with the light.
std::shared_ptr<const DiodeVoltageLaw> law_in_light(std::shared_ptr<const DiodeVoltageLaw> law,
                                                    double photocurrent_A);

}  // namespace photorque
