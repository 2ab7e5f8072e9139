// Fits of the parameters of a cell, module or shaded string to measurements.
//
// All fits are of one diode, with the whole device as one cell: n V_t is n N_s kT/q for N_s cells
// in series, and resistances and voltages are those of the device. Standard errors are those of
// least squares, from the covariance (JᵀJ)⁻¹ times the variance per degree of freedom. They are
// based on the scatter of the data instead of the stated noise.
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
  std::vector<double> voltage_V, current_A;  // equal lengths, at least 6 points
  // For each reading, or empty: irradiance over its mean, and rate of the voltage, in V/s if
  // `is_timed`, otherwise in V per reading.
  std::vector<double> light = {}, rate_V_s = {};
  bool is_timed = false;

  // The sweep without the readings whose element of `out` is not zero.
  IvSweep without(const std::vector<char>& out) const;
};

// The noise of a sweep. The error of the current is proportional to the current, with a correlation
// exp(−k/length) over k points (slow drift of the light). The error of the voltage is proportional
// to the voltage and independent.
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
  // The one-sided limit at 95 %, if the data do not exclude an infinite shunt or a series
  // resistance of zero. The estimate above is then no measurement.
  std::optional<double> shunt_above_ohm = {};
  std::optional<double> series_below_ohm = {};

  CellParameters parameters(double temperature_K) const;
};

// A bound at which a fit ended: its key, value and meaning.
struct BoundReached {
  std::string key;
  double value = 0.0;
  std::string meaning;
};

// A reading that is far from every curve through the others.
struct OutlierReading {
  size_t sweep = 0;
  double voltage_V = 0.0, current_A = 0.0;
};

// The charge stored in the junction, from sweeps in both directions. It draws the current τ dI_D/dt
// (diffusion capacitance τ dI_D/dV), where I_D is the current of the diode.
struct ChargeStorage {
  Estimate time;  // τ in s, or in readings where the sweeps have no times
  bool is_timed = false;
  double largest_A = 0.0;  // largest difference of the current between the directions
};

struct SweepFit {
  SingleDiode diode;  // at the mean irradiance of the sweeps
  std::vector<BoundReached> bounds;
  double rms_A = 0.0;     // rms of the current at the measured voltages
  double variance = 0.0;  // per degree of freedom, in units of the given noise
  size_t points = 0;
  std::vector<OutlierReading> outliers;  // readings that are left out
  bool uses_light = false;               // whether the irradiance of single readings is used
  std::optional<ChargeStorage> storage = {};
};

// Fits one set of parameters to all sweeps (repeats in equal light). The irradiance of single
// readings is used unless it doubles the scatter. If both directions of the voltage occur, τ of the
// charge storage is fitted. It is reported if it is more than three standard errors from zero.
//
// Generalised least squares in the current. The covariance of a sweep is that of its noise; the
// error of the voltage is converted by the slope of the curve from the previous round of the fit.
// Exact data reproduce their parameters to about 1e-12. Readings that deviate by more than eight of
// their errors, and by eight times the median, are left out as outliers if they are at most 10 %.
// Throws InputError for a sweep of less than six points or without a short or open circuit within
// reach.
SweepFit fit_sweeps(std::span<const IvSweep> sweeps, const SweepNoise& noise);

// Sweeps whose voltages were set in equal steps from zero (repeats of one ramp). The step is the
// mean over all points, which removes the noise of single voltages: that would blur the steep end
// of the curve. The remaining noise is that of the mean. Throws InputError unless all sweeps have
// the same number of points, at least six, and steps equal within 20 times the noise.
struct EvenSweeps {
  std::vector<IvSweep> sweeps;
  SweepNoise noise;
};
EvenSweeps with_even_steps(std::span<const IvSweep> sweeps, const SweepNoise& noise);

// The values of a datasheet, or of one measured curve.
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

// Independent errors of the values of a datasheet: rounding to a step, with a standard deviation of
// step/√12, and a relative error (one sigma).
struct RatedTolerance {
  double step_A = 0.0, step_V = 0.0;
  double fraction = 0.0;
};

// The steps in which values are written: the last decimal of any current, or of any voltage,
// because values of one kind are printed alike (22.0 may be printed as 22).
RatedTolerance written_steps(std::span<const RatedPoint> points);

// Dependence of the shunt resistance on the light.
enum class ShuntLaw {
  constant,
  inverse,      // R_sh ∝ 1/irradiance: De Soto, CEC; see in_light()
  exponential,  // with a resistance in the dark: PVsyst; not for datasheets
};

struct RatedFit {
  SingleDiode diode;  // photocurrent, and shunt, at the first point
  ShuntLaw shunt_law = ShuntLaw::constant;
  std::vector<BoundReached> bounds;
  CellModel model;              // the whole device, reference_area_m2 = 1
  double gap_error_eV = 0.0;    // standard error of the model's gap
  double first_W_m2 = 0.0;      // irradiance of the first point
  double light_exponent = 1.0;  // exponent of the photocurrent over the irradiance, from the points
  double rms = 0.0;             // relative, over V_oc, I_mp and V_mp of the given points
  double other_rms = 0.0;       // with the other law of the shunt; 0 if it was not tried
  double rms_over_known = 0.0;  // root mean square of the same, each over its known error

  // Values of the device under other conditions.
  RatedPoint predict(double irradiance_W_m2, double temperature_K) const;
};

// Fits four parameters (I₀, n V_t, R_s, R_sh) by least squares in the relative errors of V_oc, I_mp
// and V_mp at the points. The photocurrent at each point is that of its short circuit. Points at
// other temperatures than the first one (NOCT in addition to STC) are translated to that
// temperature by the slopes. A single point leaves one parameter undetermined: `ideality_guess_V`
// (n V_t of the whole device) is then kept. The gap follows from the slope of the open-circuit
// voltage. Throws InputError for values that no curve can have.
//
// Standard errors: the fit is repeated with every value changed by plus and minus its standard
// deviation, and half the differences are added in quadrature. If larger, the scatter of the
// residuals is used, provided that there are more values than parameters. Neither includes the
// errors of the one-diode model or, for a single point, of the assumed ideality.
//
// The shunt follows `shunt_law`. Without one it is constant, unless the inverse law predicts each
// of three or more points from the others with less than half the rms error. For two points the
// errors of the fits are compared. Predictions follow the measured short-circuit currents: the
// photocurrent is a power of the irradiance (called nonlinearity in IEC 60904-10).
RatedFit fit_rated_points(std::span<const RatedPoint> points, const TemperatureSlopes& slopes,
                          double ideality_guess_V, const RatedTolerance& tolerance = {},
                          std::optional<ShuntLaw> shunt_law = ShuntLaw::constant);

// A string of equal substrings, each with a bypass diode, in light that differs between them.
struct ShadedFit {
  SingleDiode substring;  // with the photocurrent of the brightest one
  std::vector<BoundReached> bounds;
  std::vector<Estimate> photocurrents_A;  // by falling light
  Estimate bypass_drop_V;
  double rms_A = 0.0;

  ArrayCurve curve(double temperature_K) const;
};

// Fits the photocurrents of `substrings` ≥ 1 equal substrings, and their common parameters, to one
// sweep.
ShadedFit fit_shaded_string(const IvSweep& sweep, int substrings, const SweepNoise& noise);

}  // namespace photorque
