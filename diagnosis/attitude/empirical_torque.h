// A fitted law without a name, as numbers against its variable and as a short formula.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "attitude/disturbances/unknown/shape.h"
#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// A fitted function without a law as a short formula, and similar physics.

// "(4.41 ± 0.02)×10⁻⁶", the value to the two digits that the error has; without an error that is
// above 0 and finite, the value alone.
std::string with_error(double value, double sigma);

struct EmpiricalFormula {
  std::string text;  // with its constants and one standard error of each; empty: none is short
  std::string looks_like;  // physics that commonly looks like this, without a claim
};

// `parameters` are those of empirical_torque(shape), as fitted; `covariance` is theirs in SI, in
// the same order. Components below three standard errors are left out of the text, but for the
// largest.
EmpiricalFormula formula_of(const EmpiricalShape& shape,
                            const std::vector<FittedParameter>& parameters,
                            const Eigen::MatrixXd& covariance);

// The empirical parts of a trial along its first run: means over bins of the variable, with the
// standard errors that follow from the covariance of the law's coefficients.
std::vector<EmpiricalTorque> empirical_torques(const Trial& chosen, const Candidates& all,
                                               const std::vector<Observation>& runs);

}  // namespace photorque
