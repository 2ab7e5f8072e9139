// The nominal module: one diode fitted to reference curves, or a datasheet.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "diagnosis/light/module/curve.h"
#include "diagnosis/light/module/design.h"

namespace photorque {

// A curve with its condition and the errors of its points.
struct ModuleSweep {
  std::string name;
  double temperature_K = 298.15;             // stated
  std::vector<double> voltage_V, current_A;  // rising voltage
  double light = 1.0;    // relative to the reference, from the currents at low voltage
  double noise_A = 0.0;  // noise of a reading; estimated from its neighbours if not stated

  // The curve with the points whose indices `keeps` accepts.
  ModuleSweep selected(const std::function<bool(size_t point)>& keeps) const;
};

// Thins a sweep to at most `max_rows` points by voltage. Removes outliers, and points beyond open
// circuit with a reverse current above 5 % of the largest current; `rejected` counts both. Throws
// InputError for fewer than 12 points or no current.
ModuleSweep module_sweep(const LightRecording& recording, const ModuleDesign& design,
                         size_t max_rows, std::map<std::string, int64_t>* rejected);

struct ModuleNominal {
  ModuleCell cell;
  // Order: logarithms of photocurrent, saturation current, ideality, series and shunt resistance,
  // then the powers of Translation. All are distributed as (nominal value) + root · N(0, 1).
  static constexpr Eigen::Index numbers = 10;
  using Numbers = Eigen::Matrix<double, numbers, 1>;
  Eigen::Matrix<double, numbers, numbers> root = Eigen::Matrix<double, numbers, numbers>::Zero();
  // Residual of the one-diode model of the reference beyond noise, relative to the short-circuit
  // current, and its correlation length in voltage.
  double misfit = 0.0, correlation_V = 0.0;
  double voltage_noise_V = 0.0;
};

// The cell with its parameters shifted by root · z.
ModuleCell moved(const ModuleNominal& nominal, const ModuleNominal::Numbers& z);

// Distance of a condition from the reference: root sum of squares of e-folds of light and steps of
// 25 K.
double distance_of(const ModuleNominal& nominal, double light, double temperature_K);

// The nominal module from the references or the datasheet. Throws InputError for references that no
// diode fits.
ModuleNominal nominal_module(const ModuleDesign& design);

// The standard deviation of each point of a sweep: the noise of its readings and the misfit of one
// diode. The misfit varies slowly and therefore counts once per correlation length. It grows with
// the distance from the reference because of the error of the translation.
double point_sigma_A(const ModuleNominal& nominal, const ModuleSweep& sweep);

// The rms deviation of the points of a healthy module from its curve: equal errors without the
// correlation factor.
double point_rms_A(const ModuleNominal& nominal, const ModuleSweep& sweep);

}  // namespace photorque
