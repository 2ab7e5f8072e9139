// What a published power and efficiency require of an array, by physics.
#pragma once

#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/array/losses.h"
#include "tools/runs/console.h"
#include "tools/runs/published.h"

namespace photorque {

// [array.target], at zero tilt. A key that is left out is the figure "array_power_W" or
// "array_efficiency" of the experiment's [[published]] at zero tilt.
struct ArrayTarget {
  double power_W = 0.0;
  double efficiency = 0.0;  // of the light on the cells
};

// InputError for a figure that is neither given nor published.
ArrayTarget read_array_target(const Settings& target,
                              const std::vector<PublishedFigure>& published);

// What the target requires: EQE V_oc FF, light on the cells; what remains of it at the tilts that
// powers were published for; what known cells reach; what changes the power of this array. Tables
// "target", "known_cells", "sensitivities".
Product target_report(const Console& console, const ArrayTarget& target,
                      const std::vector<PublishedFigure>& published, const ArrayDesign& design,
                      const ArrayResult& result, const LossInputs& light, double tilt_rad);

}  // namespace photorque
