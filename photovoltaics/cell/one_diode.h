// The voltage of a cell of one diode without breakdown, at any temperature, by one table.
//
// With s = n₁V_t, G = 1/R_sh and a = G s/I₁ the dark current (cell.h, eq. 2 with I₂ = 0 and no
// breakdown) at a diode voltage V_d = s (y + ln a) is
//
//   j = I₁ (e^{V_d/s} − 1) + G V_d   if and only if   y + e^y = L,   L = (j + I₁)/(G s) − ln a,
//
// so that y is one function of one number, whatever the cell and its temperature: Wright's omega
// function is e^y (R. Corless, D. Jeffrey, Lecture Notes in Computer Science 2385, 76 (2002)). Its
// derivatives follow, y′ = 1/(1 + e^y) and y″ = −e^y y′³; pieces of degree five match all three at
// their ends. A recording in which every row has a temperature of its own needs no table of each.
#pragma once

#include "photovoltaics/cell/cell.h"

namespace photorque {

// y + e^y = L for any finite L, to 1e-13 of the larger of 1 and |y|.
double wright_log_omega(double L);

class OneDiode {
 public:
  // `parameters` without second diode and breakdown; `thermal_V` = kT/q.
  OneDiode(const CellParameters& parameters, double thermal_V);

  // V_d at a dark current of either sign, and its derivatives by it.
  struct Point {
    double value_V = 0.0, slope_ohm = 0.0, curvature_V_A2 = 0.0;
  };
  Point at(double dark_A) const;

 private:
  double saturation_A_, scale_V_, shunt_S_, log_a_, per_A_;
};

}  // namespace photorque
