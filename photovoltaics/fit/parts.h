// Functions of the fits of fit.h: bounds, regression, and one-sided limits of parameters that the
// data do not determine.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/product.h"
#include "inference/estimator/fit.h"
#include "inference/estimator/forward_model.h"
#include "photovoltaics/fit/fit.h"

namespace photorque {

// Temperature at which n V_t is converted into an ideality; the result does not depend on it.
constexpr double fit_temperature_K = 298.15;

// The circuit of one diode with n V_t = `scale_V` at `temperature_K`.
CellParameters single_diode(double saturation_A, double scale_V, double series_ohm,
                            double shunt_ohm, double temperature_K = fit_temperature_K);

// The circuit of one diode, by its numbers.
struct DiodeCircuit {
  double saturation_A, scale_V, series_ohm, shunt_S;
};
// Current and slope of a lit diode at a reading, and the derivatives of the current.
struct DiodeCurrent {
  double current_A;
  double slope_S;  // −dI/dV
  // By the photocurrent, by the logarithms of I₀, a = n V_t, R_s and G = 1/R_sh, and by τ.
  Eigen::Matrix<double, 1, 6> derivatives_A;
};
// The currents at the readings of a sweep, with the photocurrent `light_A` at light 1, from
// 0 = I_L − I₀ (e^{V_d/a} − 1) − G V_d − τ g dV_d/dt − I, with V_d = V + I R_s, g = I₀ e^{V_d/a}/a
// and dV_d/dt = dV/dt/(1 + (g + G) R_s). Without `storage`, τ is 0 and has no derivative.
std::vector<DiodeCurrent> currents_of(const DiodeCircuit& circuit, double light_A,
                                      const IvSweep& sweep, std::optional<double> storage = {});
// Sum of the squared differences of the readings from such currents [A²].
double squares_A2(const IvSweep& sweep, const std::vector<DiodeCurrent>& currents);

// e^x with its error.
inline Estimate exponential(double x, double error) {
  return {std::exp(x), std::exp(x) * error};
}

// Whether no exponential of a parameter can overflow.
inline bool reasonable(const Eigen::VectorXd& x) {
  return x.allFinite() && (x.array().abs() < 300.0).all();
}

// The gap E₀ in (0.01, 20) eV with which a figure of the device that falls with the temperature
// changes by `slope_1_K` times 10 K over the next 10 K above the model's temperature. The
// photocurrent `light_A` meanwhile grows by `growth_1_K`.
using CellFigure = std::function<double(const CellCurve& cell, double light_A)>;
double gap_of_slope_eV(const CellModel& model, double light_A, double growth_1_K,
                       const CellFigure& figure, double slope_1_K);
// That of V_oc [V].
double gap_of_voltage_slope_eV(const CellModel& model, double light_A, double growth_1_K,
                               double slope_V_K);

// Throws InputError for too few points, unequal columns or numbers that are not finite.
void check_sweep(const IvSweep& sweep);

// The current of the point nearest to 0 V, and the highest voltage with a current. For a sweep that
// ends before the axes both are only approximate starts. Throws InputError if the sweep has no
// positive current or voltage.
struct SweepEnds {
  double short_circuit_A = 0.0, open_circuit_V = 0.0;
};
SweepEnds sweep_ends(const IvSweep& sweep);

// Limits of resistances as parts of V_oc/I_sc: beyond them no curve depends on a resistance.
constexpr double least_resistance_part = 1e-9;
constexpr double most_resistance_part = 1e9;

// One-sided limit of a parameter that is the logarithm of something that vanishes in an ideal
// device: a series resistance, or the conductance of a leak. If the data exclude the lower bound of
// parameter `k` at 95 % (one-sided), the parameter is determined and there is no limit. Otherwise
// the limit is the value at which the profile of χ² (all others refitted) has risen by 2.706 times
// the variance, the point that 5 % of a normal distribution exceed (S. S. Wilks, Annals of
// Mathematical Statistics 9 (1938) 60). It never exceeds the upper bound. `best`: the fit, whose
// parameters have finite bounds at k. `residuals`: the fitted residuals. `variance` > 0: variance
// of a residual, 1 if residuals are divided by their noise.
std::optional<double> upper_limit(const inference::Fit& best,
                                  const inference::ResidualFunction& residuals, Eigen::Index k,
                                  double variance);

// The logarithms of I₀, n V_t, R_s and 1/R_sh, which are x[first] and the three elements after it,
// as parameters of a fit. Both resistances are kept within those parts of `ohm`, V_oc/I_sc of the
// device.
std::vector<inference::Parameter> diode_parameters(const Eigen::VectorXd& x, Eigen::Index first,
                                                   double ohm);
// The diode of these four parameters, with their standard errors.
SingleDiode diode_at(const Estimate& photocurrent_A, const Eigen::VectorXd& x,
                     const Eigen::VectorXd& error, Eigen::Index first);

// Values of a device at its model's reference area, at a photocurrent.
RatedPoint rated_point_of(const CellModel& model, double light_A, double irradiance_W_m2,
                          double temperature_K);

// Sets the limits of `diode` for resistances that the fit does not determine.
void limit_resistances(const inference::Fit& best, const inference::ResidualFunction& residuals,
                       Eigen::Index series, Eigen::Index shunt, double variance,
                       SingleDiode& diode);

// The key of a parameter at a bound, and the meaning of a fit that ended there.
struct NamedBound {
  Eigen::Index parameter;
  std::string key;       // key of the quantity e^(sign · parameter)
  double sign;           // 1 or −1
  std::string at_least;  // meaning of the parameter's lower bound
  std::string at_most;   // meaning of its upper bound
};
// `first`: index of the first parameter in a point, after those of single runs.
std::vector<BoundReached> bounds_reached(const inference::Fit& best,
                                         std::span<const NamedBound> named, Eigen::Index first = 0);

// Deviation of each reading of a sweep from its curve, in units of its error. `light_A`: the
// photocurrent.
std::vector<double> deviations(const IvSweep& sweep, const std::vector<DiodeCurrent>& currents,
                               const SweepNoise& noise, double light_A);
// Moves readings that errors do not explain from the sweeps to `taken`, and refits, until there are
// none. `off`: the deviations of a sweep at a point of the fit. Many such readings, or more than
// two in a row, are not accidental: then the curve is not that of a diode, and they are kept.
inference::Fit refit_without_outliers(
    inference::Fit fit, std::span<IvSweep* const> sweeps,
    const std::function<std::vector<double>(size_t sweep, const Eigen::VectorXd& at)>& off,
    const std::function<inference::Fit(const Eigen::VectorXd& start)>& refit,
    std::vector<OutlierReading>& taken);

// Bounds of the two resistances in every fit.
std::vector<NamedBound> resistance_bounds(Eigen::Index series, Eigen::Index shunt);

}  // namespace photorque
