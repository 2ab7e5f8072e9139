// Electric power of the experiment's solar array from a trace.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "photovoltaics/array/array.h"
#include "tools/runs/array_report.h"
#include "tools/runs/optical_run.h"

namespace photorque {

// The `[array]` of an experiment, prepared for evaluation after each trace.
struct ArrayPower {
  ArrayDesign design;
  size_t flux_map = 0;              // index among the receivers
  std::optional<size_t> incidence;  // index of the IncidenceReceiver
  std::optional<size_t> back_map;   // index of the map of the back, for bifacial cells
  double bifaciality = 0.0;
  std::vector<double> responsivity_A_W;        // per band of the scene
  std::vector<double> ideal_responsivity_A_W;  // with every photon converted
  std::vector<std::string> notices;            // one line each
  std::string spectra;                         // of the lamps, in words
  ArrayReport report;
};

// Reads `[array]`; its key `receiver` names the flux map with the cells (default: the first).
// Throws InputError if the experiment has no array, and for unknown keys. Adds a receiver to the
// run if the angle of the light matters: with [array.cover], and on a surface with optics that
// depend on the angle. `known`: the array of a run with the same lamps, whose spectra are not
// evaluated again.
ArrayPower read_array_power(OpticalRun& run, const ArrayPower* known = nullptr);

// Light on the cells in a traced run; of that on the back the bifaciality enters.
ArrayLight light_on(const ArrayPower& array, const OpticalRun& run, std::span<const BinSums> sums);

// Computes the array, in the steady state unless the temperature of the cells is stated. Throws
// InputError if the cells deliver more than they absorb.
ArrayResult evaluate(const ArrayPower& array, const OpticalRun& run, const TraceResult& result);

// Text such as "steady state: both faces in still air of 293.15 K, emissivity 0.84", or "as
// stated".
std::string origin_of_temperature(const ArrayDesign& design);
// Text such as "331 K (58 °C)".
std::string show_temperature(double kelvin);
// Warning for cells above their rated temperature; empty otherwise.
std::optional<std::string> above_rated(const ArrayDesign& design, double kelvin);

// array_product() with the fractions that need the emitted power: "illumination_efficiency" (power
// on the cells over emitted power) and "light_to_electric_efficiency"; and the table
// "cell_temperature" with its origin and the loss of power per kelvin.
Product array_power_product(const ArrayDesign& design, const ArrayResult& array,
                            const TraceResult& result);

// Warning if the array delivers more than its surface absorbs of the light on the cells.
std::optional<std::string> above_absorbed(const ArrayPower& array, const OpticalRun& run,
                                          const TraceResult& result, const ArrayResult& power);

void print_array(const Console& console, const ArrayPower& read, const ArrayResult& array,
                 const TraceResult& result);

}  // namespace photorque
