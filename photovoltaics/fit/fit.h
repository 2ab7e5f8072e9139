// The parameters of a cell, module or shaded string from measurements.
//
// All fits are of one diode with the whole device as one cell: n V_t stands for n N_s kT/q of N_s
// cells in series, resistances and voltages are the device's. Standard errors are those of least
// squares, from the covariance (JᵀJ)⁻¹ times the variance per degree of freedom, so that they rest
// on the scatter of the data and not on the noise that was stated.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/product.h"
#include "photovoltaics/cell/model.h"
#include "photovoltaics/network/curve.h"

namespace photorque {

// One current–voltage sweep in the order in which it was measured.
struct IvSweep {
  std::vector<double> voltage_V, current_A;  // of equal length, at least 6 points
  // For each reading, or empty: irradiance over its mean, and rate of the voltage, in V/s if
  // `is_timed`, otherwise in V per reading.
  std::vector<double> light = {}, rate_V_s = {};
  bool is_timed = false;

  // Without the readings whose element of `out` is not zero.
  IvSweep without(const std::vector<char>& out) const;
};

// The noise of a sweep. Both errors are proportional: to the current with a correlation
// exp(−k/length) over k points (slow drift of the light), and independent to the voltage.
struct SweepNoise {
  double current_fraction = 1e-3;  // > 0
  double voltage_fraction = 5e-4;  // > 0
  double correlation_points = 0.0;
};

struct SingleDiode {
  Estimate photocurrent_A;
  Estimate saturation_A;
  Estimate scale_V;  // n V_t
  Estimate series_ohm;
  Estimate shunt_ohm;
  // Where the data do not exclude an infinite shunt, or a series resistance of zero: the one-sided
  // limit at 95 %. The estimate above is then no measurement.
  std::optional<double> shunt_above_ohm = {};
  std::optional<double> series_below_ohm = {};

  CellParameters parameters(double temperature_K) const;
};

// A bound on which a fit ended: its figure, value and meaning.
struct BoundReached {
  std::string key;
  double value = 0.0;
  std::string meaning;
};

// A reading that no curve near the others comes close to.
struct OutlierReading {
  size_t sweep = 0;
  double voltage_V = 0.0, current_A = 0.0;
};

// The charge stored in the junction, from sweeps in both directions: it takes the current
// τ dI_D/dt (diffusion capacitance τ dI_D/dV), I_D the current of the diode.
struct ChargeStorage {
  Estimate time;  // τ in s, or in readings where the sweeps have no times
  bool is_timed = false;
  double largest_A = 0.0;  // largest difference of the current between the directions
};

struct SweepFit {
  SingleDiode diode;  // at the mean irradiance of the sweeps
  std::vector<BoundReached> bounds;
  double rms_A = 0.0;     // of current at the measured voltages
  double variance = 0.0;  // per degree of freedom, in units of the noise given
  size_t points = 0;
  std::vector<OutlierReading> outliers;  // left out
  bool uses_light = false;               // the irradiance of single readings
  std::optional<ChargeStorage> storage = {};
};

// One set of parameters for all sweeps (repeats under the same light). The irradiance of single
// readings is used where the fit is better with it. If both directions of the voltage occur, τ of
// the charge storage is fitted, and stated where it is more than three standard errors from zero.
//
// Generalised least squares in the current: the covariance of a sweep is that of its noise, with
// the voltage's error carried over by the curve's slope, taken from the fit of the round before.
// Exact data give their parameters back to about 1e-12. Readings more than eight of their errors
// off, and eight times the median, are left out as outliers, as long as they are at most 10 %.
// Throws InputError for a sweep of less than six points or without a short or open circuit in
// reach.
SweepFit fit_sweeps(std::span<const IvSweep> sweeps, const SweepNoise& noise);

// Sweeps whose voltages were set in equal steps from zero (repeats of one ramp): the step is the
// mean over all points, so that the noise of single voltages, which blurs the steep end of the
// curve, falls out. The noise left is that of the mean. Throws InputError unless all sweeps have
// the same number of points, at least six, and steps equal within 20 times the noise.
struct EvenSweeps {
  std::vector<IvSweep> sweeps;
  SweepNoise noise;
};
EvenSweeps with_even_steps(std::span<const IvSweep> sweeps, const SweepNoise& noise);

// The figures of a datasheet, or of one measured curve.
struct RatedPoint {
  double irradiance_W_m2 = 1000.0;
  double temperature_K = 298.15;
  double short_circuit_A = 0.0;
  double open_circuit_V = 0.0;
  double maximum_A = 0.0;
  double maximum_V = 0.0;
};

// Temperature slopes of short-circuit current and open-circuit voltage, as in datasheets.
struct TemperatureSlopes {
  double short_circuit_1_K = 0.0;  // fraction per kelvin
  double open_circuit_1_K = -3e-3;
};

// Independent errors of the figures of a datasheet: rounded to a step,
// which is a standard deviation of step/√12, and off by a fraction of themselves (one sigma).
struct RatedTolerance {
  double step_A = 0.0, step_V = 0.0;
  double fraction = 0.0;
};

// The steps in which figures are written: the last decimal that any current, or any voltage, has,
// since figures of one kind are printed alike (22.0 may be printed as 22).
RatedTolerance written_steps(std::span<const RatedPoint> points);

// Dependence of the shunt resistance on the light.
enum class ShuntLaw {
  constant,
  inverse,      // R_sh ∝ 1/irradiance: De Soto, CEC; see in_light()
  exponential,  // with a resistance in the dark: PVsyst; not of a datasheet
};

struct RatedFit {
  SingleDiode diode;  // photocurrent, and shunt, at the first point
  ShuntLaw shunt_law = ShuntLaw::constant;
  std::vector<BoundReached> bounds;
  CellModel model;              // of the whole device, reference_area_m2 = 1
  double gap_error_eV = 0.0;    // standard error of the model's gap
  double first_W_m2 = 0.0;      // irradiance of the first point
  double light_exponent = 1.0;  // of the photocurrent over the irradiance, by the points
  double rms = 0.0;             // relative, over V_oc, I_mp and V_mp of the points given
  double other_rms = 0.0;       // under the other law of the shunt; 0 where it was not tried
  double rms_over_known = 0.0;  // root mean square of the same over how well each is known

  // Figures of the device under other conditions.
  RatedPoint predict(double irradiance_W_m2, double temperature_K) const;
};

// Four parameters (I₀, n V_t, R_s, R_sh) by least squares in the relative errors of V_oc, I_mp and
// V_mp at the points; at each, the photocurrent is that of its short circuit. Points at other
// temperatures than the first (a sheet's NOCT beside its STC) are moved to that by the slopes. One
// point leaves one parameter open: `ideality_guess_V` (n V_t of the whole device) is then kept. The
// gap follows from the slope of the open-circuit voltage. Throws InputError for figures that no
// curve can have.
//
// Standard errors: the fit is repeated with every figure moved by its standard deviation both ways,
// and half the differences add up in quadrature; or, if larger, the scatter of the residuals where
// there are more figures than parameters. What one diode cannot describe at all is in neither, nor
// is, for one point alone, that the ideality was assumed.
//
// The shunt follows `shunt_law`; without one it is constant, unless the inverse law predicts each
// of three or more points from the others with less than half the rms error. Of two points the
// errors of the fits are compared. Predictions follow the measured short-circuit currents: the
// photocurrent is a power of the irradiance (IEC 60904-10 calls the departure nonlinearity).
RatedFit fit_rated_points(std::span<const RatedPoint> points, const TemperatureSlopes& slopes,
                          double ideality_guess_V, const RatedTolerance& tolerance = {},
                          std::optional<ShuntLaw> shunt_law = ShuntLaw::constant);

// A string of like substrings, each with a bypass diode, under light that differs between them.
struct ShadedFit {
  SingleDiode substring;  // photocurrent of the brightest
  std::vector<BoundReached> bounds;
  std::vector<Estimate> photocurrents_A;  // by falling light
  Estimate bypass_drop_V;
  double rms_A = 0.0;

  ArrayCurve curve(double temperature_K) const;
};

// Photocurrents of `substrings` ≥ 1 like substrings, and what they share, from one sweep.
ShadedFit fit_shaded_string(const IvSweep& sweep, int substrings, const SweepNoise& noise);

}  // namespace photorque
