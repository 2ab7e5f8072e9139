#include "photovoltaics/fit/parts.h"

#include <algorithm>
#include <set>
#include <string>

#include "core/constants.h"
#include "core/errors.h"

namespace photorque {

CellParameters single_diode(double saturation_A, double scale_V, double series_ohm,
                            double shunt_ohm, double temperature_K) {
  CellParameters p;
  p.saturation_1_A = saturation_A;
  p.ideality_1 = scale_V / (boltzmann_J_K * temperature_K / elementary_charge_C);
  p.series_ohm = series_ohm;
  p.shunt_ohm = shunt_ohm;
  p.temperature_K = temperature_K;
  return p;
}

CellParameters SingleDiode::parameters(double temperature_K) const {
  return single_diode(saturation_A.value, scale_V.value, series_ohm.value, shunt_ohm.value,
                      temperature_K);
}

void check_sweep(const IvSweep& sweep) {
  constexpr size_t fewest = 6;  // one more than parameters
  const size_t points = sweep.voltage_V.size();
  if (points < fewest || sweep.current_A.size() != points) {
    throw InputError({}, "curves", std::to_string(points) + " points",
                     "at least 6 pairs of voltage and current");
  }
  for (size_t i = 0; i < points; ++i) {
    if (!std::isfinite(sweep.voltage_V[i]) || !std::isfinite(sweep.current_A[i])) {
      throw InputError({}, "curves", "point " + std::to_string(i + 1) + " without a number",
                       "finite numbers");
    }
  }
  const std::set<double> voltages_V(sweep.voltage_V.begin(), sweep.voltage_V.end());
  if (voltages_V.size() < fewest) {
    throw InputError({}, "curves", std::to_string(voltages_V.size()) + " different voltages",
                     "at least 6");
  }
}

SweepEnds sweep_ends(const IvSweep& sweep) {
  SweepEnds ends;
  double nearest_V = 1e300;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (std::abs(sweep.voltage_V[i]) < nearest_V) {
      nearest_V = std::abs(sweep.voltage_V[i]);
      ends.short_circuit_A = sweep.current_A[i];
    }
    if (sweep.current_A[i] >= 0.0) {
      ends.open_circuit_V = std::max(ends.open_circuit_V, sweep.voltage_V[i]);
    }
  }
  if (!(ends.short_circuit_A > 0.0) || !(ends.open_circuit_V > 0.0)) {
    throw InputError({}, "curves", "no point with positive current and voltage",
                     "a sweep of a lit cell, currents positive");
  }
  return ends;
}

EvenSweeps with_even_steps(std::span<const IvSweep> sweeps, const SweepNoise& noise) {
  EvenSweeps even{{sweeps.begin(), sweeps.end()}, noise};
  double step_V = 0.0, count = 0.0;
  for (const IvSweep& sweep : sweeps) {
    check_sweep(sweep);
    if (sweep.voltage_V.size() != sweeps[0].voltage_V.size()) {
      throw InputError({}, "even_voltage_steps", "sweeps of different lengths", "equal lengths");
    }
    for (size_t k = 1; k < sweep.voltage_V.size(); ++k, ++count) {
      step_V += sweep.voltage_V[k] / static_cast<double>(k);
    }
  }
  step_V /= count;
  for (IvSweep& sweep : even.sweeps) {
    for (size_t k = 0; k < sweep.voltage_V.size(); ++k) {
      const double set_V = step_V * static_cast<double>(k);
      const double allowed_V = 20.0 * noise.voltage_fraction * std::max(set_V, step_V);
      if (std::abs(sweep.voltage_V[k] - set_V) > allowed_V) {
        throw InputError({}, "even_voltage_steps", std::to_string(sweep.voltage_V[k]) + " V",
                         "about " + std::to_string(set_V) + " V at point " + std::to_string(k + 1));
      }
      sweep.voltage_V[k] = set_V;
    }
  }
  even.noise.voltage_fraction /= std::sqrt(count);
  return even;
}

}  // namespace photorque
