// The nominal model of light and power before any fit: the effects that an experiment states, and
// its uncertain values.
//
// Each uncertain value is a nuisance parameter p of every trial, in units of its error, with a
// Gaussian prior of width 1. Its derivative is a finite difference: the experiment is read again
// with plus and minus a tenth of the error. If only one side is within the range (a quantum
// efficiency of 1), the nominal value is the other side.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/light/model/run.h"
#include "scenes/experiment/uncertain.h"

namespace photorque {

struct LightPrior {
  std::string key;            // "source[0].power_W"
  std::vector<double> value;  // all values of the key in its unit, before any fit
  size_t component = 0;       // index of the uncertain value
  double sigma = 1.0;         // standard deviation of the uncertain value
  static constexpr double part = 0.1;
  struct Side {
    std::shared_ptr<const LightLab> lab;
    LightState state;
    double errors = 0.0;  // shift in standard deviations: −part, part, or 0
  };
  Side low, high;
};

// ∂(predicted/noise) of a recording with respect to each prior.
Eigen::MatrixXd slopes_by_priors(const LightRun& run, const std::vector<LightPrior>& priors);

// The nominal model: `state` acts in addition to the experiment; `uncertain` are its priors.
struct NominalLight {
  LightState state;
  std::vector<LightPrior> uncertain = {};
};

// `reread` reads the experiment of the lab again with one more key assigned. The lab must outlive
// the result. Throws InputError if an uncertain value cannot be varied in either direction.
NominalLight nominal_light(const LightLab& lab, const std::vector<UncertainKey>& uncertain,
                           const std::function<Experiment(const std::string&)>& reread);

// Key of the prior on the tilt of the body in the light, among the refined priors. Experiments do
// not have this key.
constexpr const char* tilt_prior = "attitude_bias.bias_deg";

// Adds a prior on the rotation of the body relative to its recorded attitude, as a rotation vector
// about lab x and y with errors. The lab must outlive it.
void add_tilt_prior(const LightLab& lab, const Vec2& bias_rad, const Vec2& sigma_rad,
                    NominalLight& nominal);

}  // namespace photorque
