// From a trace to the electric power of the experiment's solar array.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "photovoltaics/array/array.h"
#include "tools/runs/array_report.h"
#include "tools/runs/optical_run.h"

namespace photorque {

// The `[array]` of an experiment, ready to be evaluated after each trace.
struct ArrayPower {
  ArrayDesign design;
  size_t flux_map = 0;                         // place among the receivers
  std::optional<size_t> incidence;             // that of the IncidenceReceiver
  std::vector<double> responsivity_A_W;        // per band of the scene
  std::vector<double> ideal_responsivity_A_W;  // were every photon converted
  std::vector<std::string> notices;            // one line each
  ArrayReport report;
};

// Reads `[array]`; its key `receiver` names the flux map that holds the cells (default: the first
// one). InputError when the experiment has no array, and for unknown keys. Adds a receiver to the
// run where the light's angle counts: under [array.cover], and on a surface with optics by angle.
// `known`: the array of a run with the same lamps, whose spectra need not be looked at again.
ArrayPower read_array_power(OpticalRun& run, const ArrayPower* known = nullptr);

ArrayResult evaluate(const ArrayPower& array, const OpticalRun& run, const TraceResult& result);

// array_product() and the fractions that need the emitted power: "illumination_efficiency" (power
// on the cells over emitted) and "light_to_electric_efficiency".
Product array_power_product(const ArrayResult& array, const TraceResult& result);

void print_array(const Console& console, const ArrayResult& array, const TraceResult& result);

}  // namespace photorque
