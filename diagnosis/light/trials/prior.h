// Numbers of the nominal model of light that are known to within an error.
//
// Each is a nuisance p of every trial, in units of its error, with a Gaussian prior of width 1. The
// recordings move with it as a difference says, between a tenth of its error more and less: the
// experiment is read again with either. Where it bears only one of them (a quantum efficiency of
// 1), the other side is the number itself.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/light/model/run.h"

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

}  // namespace photorque
