#include "diagnosis/light/module/plausible.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"

namespace photorque {

namespace {

// The current at the voltage nearest to zero; 0 without points.
double short_circuit_A(const std::vector<double>& voltage_V, const std::vector<double>& current_A) {
  double found_A = 0.0, nearest_V = INFINITY;
  for (size_t i = 0; i < voltage_V.size(); ++i) {
    if (std::abs(voltage_V[i]) > nearest_V) continue;
    nearest_V = std::abs(voltage_V[i]);
    found_A = current_A[i];
  }
  return found_A;
}

}  // namespace

double light_of(const ModuleSweep& sweep, const ModuleNominal& nominal) {
  return std::max(short_circuit_A(sweep.voltage_V, sweep.current_A) / nominal.cell.photocurrent_A,
                  1e-3);
}

void require_plausible(const ModuleSweep& sweep, const ModuleDesign& design,
                       const ModuleNominal& nominal) {
  const ModuleCell& cell = nominal.cell;
  const double thermal_V = boltzmann_J_K * cell.temperature_K / elementary_charge_C;
  const double open_V = design.cells * cell.ideality * thermal_V *
                        std::log1p(cell.photocurrent_A / cell.saturation_A);
  const double light = light_of(sweep, nominal);
  double seen_V = 0.0;  // the largest voltage with a forward current
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (sweep.current_A[i] >= 0.0) seen_V = std::max(seen_V, sweep.voltage_V[i]);
  }
  constexpr double most_suns = 20.0, most_V = 1.25;
  if (light > most_suns) {
    throw InputError({sweep.name}, "current_A",
                     printed("%.3g times the current of the reference module", light),
                     "amperes (a column in milliamperes is named current_mA)");
  }
  if (seen_V > most_V * open_V) {
    const double exchanged = light * cell.photocurrent_A / open_V;
    constexpr double alike = 0.15;
    throw InputError({sweep.name}, "voltage_V",
                     printed("%.3g V at a current, where the reference module gives %.3g V at none",
                             seen_V, open_V),
                     std::abs(exchanged - 1.0) < alike
                         ? "the voltage: the columns of voltage and current look exchanged"
                         : "volts of the module of the experiment (a column in millivolts is named "
                           "voltage_mV)");
  }
}

void require_current_forward(const LightRecording& recording) {
  const double short_A = short_circuit_A(recording.voltage_V, recording.current_A);
  double largest_A = 0.0;
  for (const double current_A : recording.current_A)
    largest_A = std::max(largest_A, std::abs(current_A));
  if (short_A > -0.5 * largest_A) return;
  throw InputError(
      {recording.name}, "current_A", "a negative current at the smallest voltage",
      "positive currents of an illuminated module: the sign of the column is reversed");
}

void require_curve(const LightRecording& recording) {
  if (recording.kind == LightRecording::Kind::sweep) return;
  throw InputError({recording.name}, "header", "no columns voltage_V,current_A",
                   "a current-voltage curve, for an experiment with [module]");
}

}  // namespace photorque
