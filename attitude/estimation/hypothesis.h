// An attitude model with free parameters, which a fit changes.
#pragma once

#include <vector>

#include "attitude/model/dynamics.h"
#include "attitude/observation/observation.h"
#include "inference/estimator/parameter.h"

namespace photorque {

// A free parameter of a disturbance, with its Gaussian prior.
struct Free {
  size_t disturbance = 0;
  int parameter = 0;
  double mean = 0.0;
  double sigma = inference::infinity;  // > 0
  bool per_run = false;                // every run has a separate value
  // Bounds of the fit.
  double lowest = -inference::infinity;
  double highest = inference::infinity;
  // Every recording has a separate value. This means every run, unless the runs are segments into
  // which one recording was cut for the search: these share the value.
  bool per_recording = false;
};

struct RunStart {
  PlatformState initial;
  std::vector<double> own;  // values of the per-run parameters, in the order of Hypothesis::free
  double turned_rad = 0.0;  // initial angle about the only axis, with whole turns
};

// A free parameter that all runs share.
struct SharedParameter {
  size_t disturbance = 0, parameter = 0;
  Eigen::Index at = 0;  // index among the shared parameters of the fit
  double value = 0.0;
};

// A model with its free parameters at their present values.
struct Hypothesis {
  AttitudeModel model;  // contains the shared parameters; model_of() replaces its schedule
  std::vector<Free> free;
  std::vector<RunStart> runs;

  double& value(const Free& f) { return parameter(f).value; }
  Parameter& parameter(const Free& f) {
    return model.disturbances[f.disturbance].parameters[static_cast<size_t>(f.parameter)];
  }
  const Parameter& parameter(const Free& f) const {
    return model.disturbances[f.disturbance].parameters[static_cast<size_t>(f.parameter)];
  }
  // The free parameters that all runs share, in the order of the fit: all, or those of one
  // disturbance.
  std::vector<SharedParameter> shared() const;
  std::vector<SharedParameter> shared(size_t disturbance) const;
  // The model of one run, with the run's schedule and per-run parameters.
  AttitudeModel model_of(size_t run, const Observation& seen) const;
};

// Makes the per-recording parameters of `h` per run, or shared if the runs are segments of one
// recording, and converts the values. `h.runs` are the starts of `runs` with the former per-run
// values.
void adapt_to_runs(Hypothesis& h, const std::vector<Observation>& runs);

// Initial conditions of all runs from their first readings, with the per-run parameters at their
// prior means.
std::vector<RunStart> starts_from_data(const Hypothesis& h, const std::vector<Observation>& runs);

// A straight line through the first readings of one coordinate.
struct FirstLine {
  double value = 0.0, slope_1_s = 0.0;  // at the run's first block; slope: value's unit per s
};

// Least-squares line through the first `most` blocks that have a reading. With a single reading,
// its value with slope zero; without readings, zero.
inline FirstLine first_line(const Observation& seen, Scalar scalar, int most) {
  if (!seen.has(scalar)) return {};
  const ScalarReadings& read = seen.scalar[static_cast<size_t>(scalar)];
  double n = 0.0, t = 0.0, x = 0.0, tt = 0.0, tx = 0.0;
  for (size_t i = 0; i < read.rows.size() && n < most; ++i) {
    if (!(read.rows[i] > 0.0)) continue;
    const double since_s = seen.time_s[i] - seen.time_s.front();
    n += 1.0;
    t += since_s;
    x += read.value[i];
    tt += since_s * since_s;
    tx += since_s * read.value[i];
  }
  const double spread = n * tt - t * t;
  if (!(spread > 0.0)) return {n > 0.0 ? x / n : 0.0};
  const double slope_1_s = (n * tx - t * x) / spread;
  return {(x - slope_1_s * t) / n, slope_1_s};
}

}  // namespace photorque
