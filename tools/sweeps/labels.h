// Keys and figures as people read them: a name, and the unit in brackets.
#pragma once

#include <string>

#include "tools/sweeps/plan.h"

namespace photorque {

// "W/m²" of "W_m2".
std::string printed_unit(const std::string& unit);

// A name and a unit of an axis: its own name, else the last part of its key: "position z [m]" of
// source[0].position_m[2].
struct AxisLabel {
  std::string name, unit;
  std::string text() const { return unit.empty() ? name : name + " [" + unit + "]"; }
  // "position z 1.2 m"
  std::string with(const std::string& value) const;
};
AxisLabel label_of(const SweepAxis& axis);

// "array power [W]" of array_power_W; |…| of an absolute value, "95 % of built copies reach …".
AxisLabel label_of_figure(const std::string& column);

// As a title: "Array power (mean over tilt)".
std::string title_of_figure(const SweepPlan& plan, const std::string& column);

}  // namespace photorque
