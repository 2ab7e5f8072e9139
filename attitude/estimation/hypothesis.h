// An attitude model with its free parameters, which a fit moves.
#pragma once

#include <vector>

#include "attitude/model/dynamics.h"
#include "attitude/observation/observation.h"
#include "inference/estimator/parameter.h"

namespace photorque {

// A parameter of a disturbance to be fitted, with its Gaussian prior.
struct Free {
  size_t disturbance = 0;
  int parameter = 0;
  double mean = 0.0;
  double sigma = inference::infinity;  // > 0
  bool per_run = false;                // every run has its own value
  // The fit does not leave these.
  double lowest = -inference::infinity;
  double highest = inference::infinity;
  // Every recording has its own value: every run does, but where runs are pieces that one recording
  // was cut into for the search, which share it.
  bool per_recording = false;
};

struct RunStart {
  PlatformState initial;
  std::vector<double> own;  // values of the per-run parameters, in their order in Hypothesis::free
};

// A model with its free parameters at their present values.
struct Hypothesis {
  AttitudeModel model;  // shared parameters live in it; its schedule is replaced by each run's
  std::vector<Free> free;
  std::vector<RunStart> runs;

  double& value(const Free& f) { return parameter(f).value; }
  Parameter& parameter(const Free& f) {
    return model.disturbances[f.disturbance].parameters[static_cast<size_t>(f.parameter)];
  }
  const Parameter& parameter(const Free& f) const {
    return model.disturbances[f.disturbance].parameters[static_cast<size_t>(f.parameter)];
  }
  // The model of one run: its schedule and its own parameters.
  AttitudeModel model_of(size_t run, const Observation& seen) const;
};

// Makes what is per recording of `h` per run, or shared by all where the runs are pieces; the
// values go along. `h.runs` are the starts for `runs`, with what was per run until now.
void adapt_to_runs(Hypothesis& h, const std::vector<Observation>& runs);

// The initial conditions of every run from its first readings.
PlatformState first_state(const AttitudeModel& model, const Observation& seen);

// Such starts of all runs, their own parameters at the nominal model.
std::vector<RunStart> starts_from_data(const Hypothesis& h, const std::vector<Observation>& runs);

// Initial condition of one coordinate of a recording.

struct FirstLine {
  double value = 0.0, slope_1_s = 0.0;  // at the time of the run's first block; of the unit per s
};

// The line of least squares through the first `most` blocks that have a reading; of one alone its
// value; zero where the run has none.
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
