// From a trace to the electric power of the experiment's solar array.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "photovoltaics/array/array.h"
#include "tools/runs/array_report.h"
#include "tools/runs/optical_run.h"

namespace photorque {

// The `[array]` of an experiment, ready to be evaluated after each trace.
struct ArrayPower {
  ArrayDesign design;
  size_t flux_map = 0;              // place among the receivers
  std::optional<size_t> incidence;  // that of the IncidenceReceiver
  std::optional<size_t> back_map;   // of bifacial cells
  double bifaciality = 0.0;
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

// The light on the cells: of a traced run, with that on the back by its bifaciality.
ArrayLight light_on(const ArrayPower& array, const OpticalRun& run, std::span<const BinSums> sums);

// In the steady state where the temperature of the cells is not stated. InputError where they
// deliver more than they absorb.
ArrayResult evaluate(const ArrayPower& array, const OpticalRun& run, const TraceResult& result);

// `array` with its cells at the temperature of `result`, in any light.
ArrayPower held_at(ArrayPower array, const ArrayResult& result);

// "steady state: both faces in still air of 293.15 K, emissivity 0.84", or "as stated".
std::string origin_of_temperature(const ArrayDesign& design);
// "331 K (58 °C)"
std::string show_temperature(double kelvin);
// A warning of cells that are warmer than they are rated; none where they are not.
std::optional<std::string> above_rated(const ArrayDesign& design, double kelvin);

// array_product() and the fractions that need the emitted power: "illumination_efficiency" (power
// on the cells over emitted) and "light_to_electric_efficiency".
// And the table "cell_temperature": its origin, and the loss of power per kelvin.
Product array_power_product(const ArrayDesign& design, const ArrayResult& array,
                            const TraceResult& result);

void print_array(const Console& console, const ArrayDesign& design, const ArrayResult& array,
                 const TraceResult& result);

}  // namespace photorque
