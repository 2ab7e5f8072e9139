// Numbers of the nominal model of light that are known to within an error.
//
// Each is a nuisance p of every trial, in units of its error, with a Gaussian prior of width 1. The
// recordings move with it as a difference says, between a tenth of its error more and less: the
// experiment is read again with either.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/light/model/run.h"

namespace photorque {

struct LightPrior {
  std::string key;                       // "source[0].power_W"
  double value = 0.0, sigma = 1.0;       // in its unit, before anything is fitted
  size_t component = 0, components = 1;  // of an array
  // With a part of the error less and more.
  static constexpr double part = 0.1;
  struct Side {
    std::shared_ptr<const LightLab> lab;
    LightState state;
  };
  Side low, high;
};

// ∂(predicted/noise) of a recording by each.
Eigen::MatrixXd slopes_by_priors(const LightRun& run, const std::vector<LightPrior>& priors);

}  // namespace photorque
