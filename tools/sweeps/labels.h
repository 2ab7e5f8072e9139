// Labels of keys and figures: a name, and the unit in brackets.
#pragma once

#include <string>

#include "tools/sweeps/plan.h"

namespace photorque {

// Printed form of a unit: "W/m²" for "W_m2".
std::string printed_unit(const std::string& unit);

// Name and unit of an axis. The name is that stated in the plan, otherwise the last part of its
// key: "position z [m]" for source[0].position_m[2].
struct AxisLabel {
  std::string name, unit;
  std::string text() const { return unit.empty() ? name : name + " [" + unit + "]"; }
  // Text such as "position z 1.2 m".
  std::string with(const std::string& value) const;
};
AxisLabel label_of(const SweepAxis& axis);

// Label such as "array power [W]" for array_power_W; |…| for an absolute value; "95 % of built
// copies reach …".
AxisLabel label_of_figure(const std::string& column);

// Label as a title: "Array power (mean over tilt)".
std::string title_of_figure(const SweepPlan& plan, const std::string& column);

}  // namespace photorque
