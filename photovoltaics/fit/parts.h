// What the fits of fit.h share.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/estimate.h"
#include "inference/estimator/fit.h"
#include "inference/estimator/forward_model.h"
#include "photovoltaics/fit/fit.h"

namespace photorque {

// Temperature at which n V_t is turned into an ideality; it cancels.
constexpr double fit_temperature_K = 298.15;

CellParameters single_diode(double saturation_A, double scale_V, double series_ohm,
                            double shunt_ohm, double temperature_K = fit_temperature_K);

// e^x with its error.
inline Estimate exponential(double x, double error) {
  return {std::exp(x), std::exp(x) * error};
}

// No parameter so far out that its exponential overflows.
inline bool reasonable(const Eigen::VectorXd& x) {
  return x.allFinite() && (x.array().abs() < 300.0).all();
}

// Throws InputError for too few points, unequal columns or numbers that are not finite.
void check_sweep(const IvSweep& sweep);

// The current of the point nearest to 0 V, and the highest voltage at which there is a current. Of
// a sweep that ends before the axes both are the best that there is to start from. Throws
// InputError when it shows no positive current or voltage.
struct SweepEnds {
  double short_circuit_A = 0.0, open_circuit_V = 0.0;
};
SweepEnds sweep_ends(const IvSweep& sweep);

}  // namespace photorque
