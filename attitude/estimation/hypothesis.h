// An attitude model with what is free in it: what a fit moves.
#pragma once

#include <vector>

#include "attitude/estimation/observation.h"
#include "attitude/model/dynamics.h"
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

// A start of every run from what was seen at its beginning.
PlatformState first_state(const AttitudeModel& model, const Observation& seen);

// Such starts of all runs, their own parameters at the nominal model.
std::vector<RunStart> seen_starts(const Hypothesis& h, const std::vector<Observation>& runs);

}  // namespace photorque
