// Functions of the fits of fit.h: bounds and regression, and one-sided limits of parameters that
// the data do not determine.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/product.h"
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

// E₀ in (0.01, 20) eV with which V_oc of the device changes by `slope_V_K` over the next 10 K above
// the model's temperature, while the light's current `light_A` grows by `growth_1_K`.
double gap_of_voltage_slope_eV(const CellModel& model, double light_A, double growth_1_K,
                               double slope_V_K);

// Throws InputError for too few points, unequal columns or numbers that are not finite.
void check_sweep(const IvSweep& sweep);

// The current of the point nearest to 0 V, and the highest voltage at which there is a current. Of
// a sweep that ends before the axes both are the best that there is to start from. Throws
// InputError when it shows no positive current or voltage.
struct SweepEnds {
  double short_circuit_A = 0.0, open_circuit_V = 0.0;
};
SweepEnds sweep_ends(const IvSweep& sweep);

// Beyond these parts of V_oc/I_sc no curve shows a resistance; fits stay within.
constexpr double least_resistance_part = 1e-9;
constexpr double most_resistance_part = 1e9;

// Parameters of a fit that are logarithms of what vanishes in an ideal device: a series resistance,
// or the conductance of a leak. Where the data exclude the lower bound of parameter `k` at 95 %
// (one-sided), it is determined, and there is no limit. Otherwise the limit is where the profile of
// χ² (all others refitted) has risen by 2.706 times the variance, the point that 5 % of a normal
// distribution exceed (S. S. Wilks, Annals of Mathematical Statistics 9 (1938) 60); never past the
// upper bound. `best`: the fit, whose parameters have finite bounds at k; `residuals`: what it
// fitted; `variance` > 0: of a residual, 1 where residuals are over their noise.
std::optional<double> upper_limit(const inference::Fit& best,
                                  const inference::ResidualFunction& residuals, Eigen::Index k,
                                  double variance);

// Keeps logarithms of a series resistance and of a leak's conductance within those parts of
// `ohm`, V_oc/I_sc of the device.
void bound_resistances(double ohm, inference::Parameter& series, inference::Parameter& shunt);

// Sets the limits of `diode` where the fit does not determine its resistances.
void limit_resistances(const inference::Fit& best, const inference::ResidualFunction& residuals,
                       Eigen::Index series, Eigen::Index shunt, double variance,
                       SingleDiode& diode);

// A parameter's figure at a bound, and the meaning of a fit that ended there.
struct NamedBound {
  Eigen::Index parameter;
  std::string key;       // of the figure, which is e^(sign · parameter)
  double sign;           // 1 or −1
  std::string at_least;  // meaning of the parameter's lower bound
  std::string at_most;   // its upper one
};
// `first`: index of the first parameter in a point, after those of single runs.
std::vector<BoundReached> bounds_reached(const inference::Fit& best,
                                         std::span<const NamedBound> named, Eigen::Index first = 0);

// Takes readings out of sweeps that no errors explain, from how many of its errors each reading is
// `off` its curve; whether there were any. Many, or more than two in a row, are no accident: then
// the curve is another than a diode's, and they stay.
bool take_outliers(std::span<IvSweep* const> sweeps, const std::vector<std::vector<double>>& off,
                   std::vector<OutlierReading>& taken);

// Bounds of the two resistances in every fit.
std::vector<NamedBound> resistance_bounds(Eigen::Index series, Eigen::Index shunt);

}  // namespace photorque
