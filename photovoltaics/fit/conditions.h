// Fit of one set of parameters to curves in different light and at different temperatures.
#pragma once

#include <span>
#include <vector>

#include "photovoltaics/fit/fit.h"

namespace photorque {

// A curve and its temperature; irradiance 0: not stated.
struct CurveAt {
  IvSweep sweep;
  double temperature_K = 298.15;
  double irradiance_W_m2 = 0.0;
};

struct ConditionsFit {
  SingleDiode diode;  // at the reference: the first of `curves` below
  ShuntLaw shunt_law = ShuntLaw::constant;
  CellModel model;            // the whole device, reference_area_m2 = 1, at its temperature
  double gap_error_eV = 0.0;  // 0: one temperature, which does not determine the gap
  std::vector<BoundReached> bounds;
  std::vector<OutlierReading> outliers;  // readings that are left out
  struct Curve {
    size_t index = 0;  // index among the given curves
    Estimate photocurrent_A;
    double rms_A = 0.0;
    bool uses_light = false;  // whether the irradiance of its single readings is used
  };
  std::vector<Curve> curves;
  // Curves that no single diode describes. `rms`: of the best fit, relative to the photocurrent.
  struct Omitted {
    size_t index = 0;
    double rms = 0.0;
  };
  std::vector<Omitted> omitted;
  double rms = 0.0;       // rms of the current over the curve's photocurrent
  double variance = 0.0;  // per degree of freedom, in units of the noise given
  size_t points = 0;
  // Photocurrent over irradiance at the temperature of the reference, if all curves state an
  // irradiance; and the error of its slope in the model, if there are several temperatures.
  double photocurrent_A_m2_W = 0.0;
  double photocurrent_slope_error_1_K = 0.0;
};

// Fits I₀, n, R_s and R_sh shared by all curves, and a photocurrent for each curve. Between
// temperatures I₀ follows the gap (model.h, with De Soto's slope of silicon), which is fitted if
// the temperatures differ by 5 K or more.
//
// The shunt follows `shunt_law`. Without one it is constant by default. If the photocurrents differ
// by a fifth or more, the inverse law is chosen if it predicts left-out curves better by more than
// two standard errors. For five curves over a factor of four in light, the exponential law is
// chosen if it predicts still better.
//
// The irradiance of single readings is used as by fit_sweeps(). The reference is the first curve
// that is not omitted, or the brightest one if it is twice as bright. If the residuals are three
// times the noise, they are treated as an error of the model that is one fraction of each
// photocurrent.
//
// Up to a third of four or more curves are omitted if one diode does not describe them (a shadow on
// a part of the device, a cloud). A curve is omitted if the residual of its best diode exceeds 1 %
// of the photocurrent, or 0.5 % beyond the noise, and 2.5 times the median of all curves, or if its
// ideality differs from the median by a factor of 2.5. Errors of readings are independent. Outliers
// are omitted as by fit_sweeps(). Throws InputError as fit_sweeps() does.
ConditionsFit fit_conditions(std::span<const CurveAt> curves, const SweepNoise& noise,
                             std::optional<ShuntLaw> shunt_law = {});

}  // namespace photorque
