// The nominal model of light and power before any fit: the effects that an experiment states, and
// its numbers with an error.
//
// Each of these numbers is a nuisance p of every trial, in units of its error, with a Gaussian
// prior of width 1. Its derivative is a difference: the experiment is read again with a tenth of
// the error more and less. Where only one of the two is allowed (a quantum efficiency of 1), the
// other side is the number itself.
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
  std::vector<double> value;  // all of the key, in its unit, before anything is fitted
  size_t component = 0;       // the one of them that this is about
  double sigma = 1.0;         // of that
  static constexpr double part = 0.1;
  struct Side {
    std::shared_ptr<const LightLab> lab;
    LightState state;
    double errors = 0.0;  // how many of them away: −part, part, or 0
  };
  Side low, high;
};

// ∂(predicted/noise) of a recording by each.
Eigen::MatrixXd slopes_by_priors(const LightRun& run, const std::vector<LightPrior>& priors);

// The nominal model: only `state` acts in addition to the experiment; `uncertain` is known to
// within errors.
struct LightBelief {
  LightState state;
  std::vector<LightPrior> uncertain = {};
};

// `reread` is the experiment of the lab again with one more key assigned. The lab must outlive the
// result. InputError for an error of a number that can have no other value.
LightBelief light_belief(const LightLab& lab, const std::vector<UncertainKey>& uncertain,
                         const std::function<Experiment(const std::string&)>& reread);

// The key of the prior on the tilt of the body in the light, among the refined ones; no experiment
// has it.
constexpr const char* tilt_belief = "attitude_bias.bias_deg";

// A prior: the body is rotated against its recorded attitude by a rotation vector about lab x and
// y, to within errors. The lab must outlive it.
void believe_tilt(const LightLab& lab, const Vec2& bias_rad, const Vec2& sigma_rad,
                  LightBelief& belief);

}  // namespace photorque
