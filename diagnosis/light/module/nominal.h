// The nominal module: one diode fitted to reference curves, or a datasheet.
#pragma once

#include <Eigen/Core>

#include "diagnosis/light/module/curve.h"
#include "diagnosis/light/module/design.h"

namespace photorque {

// A curve with its condition and the errors of its points.
struct ModuleSweep {
  std::string name;
  double temperature_K = 298.15;             // as stated
  std::vector<double> voltage_V, current_A;  // rising voltage
  double light = 1.0;                        // over the reference, from the currents at low voltage
  double noise_A = 0.0;                      // of a reading, from its neighbours where not stated
};

// One row in `every` of a sweep's, by voltage; readings that neighbours contradict left out.
// InputError for fewer than 12 points or no current.
ModuleSweep module_sweep(const LightRecording& recording, const ModuleDesign& design,
                         size_t max_rows, int64_t* dropped);

struct ModuleNominal {
  ModuleCell cell;
  // Of the logarithms of photocurrent, saturation current, ideality, series and shunt resistance,
  // and of the powers of Translation in their order: all within (number) + root · N(0, 1).
  static constexpr Eigen::Index numbers = 10;
  using Numbers = Eigen::Matrix<double, numbers, 1>;
  Eigen::Matrix<double, numbers, numbers> root = Eigen::Matrix<double, numbers, numbers>::Zero();
  // Residual of the one-diode model of the reference beyond its noise, over the short-circuit
  // current, and the voltage over which that residual changes.
  double misfit = 0.0, correlation_V = 0.0;
  double voltage_noise_V = 0.0;
};

ModuleWiring wiring_of(const ModuleDesign& design);
// The cell with its numbers moved by root · z.
ModuleCell moved(const ModuleNominal& nominal, const ModuleNominal::Numbers& z);

// How far a curve is from the reference: e-folds of light and steps of 25 K, as the root of their
// squares.
double distance_of(const ModuleNominal& nominal, const ModuleSweep& sweep);

// InputError for references that no diode fits.
ModuleNominal nominal_module(const ModuleDesign& design);

// The standard deviation of each point of a sweep: the noise of its readings and the misfit of one
// diode, which changes slowly and therefore counts once per correlation length. It grows with the
// distance from the reference, because the translation to another condition has an error.
double point_sigma_A(const ModuleNominal& nominal, const ModuleSweep& sweep);

// The root of the mean square by which the points of a healthy module may differ from its curve:
// the same errors, each counted once.
double point_rms_A(const ModuleNominal& nominal, const ModuleSweep& sweep);

}  // namespace photorque
