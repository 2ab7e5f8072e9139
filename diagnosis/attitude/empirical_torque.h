// A fitted empirical law as a table over its variable and as a short formula.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "attitude/disturbances/unknown/shape.h"
#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// "(4.41 ± 0.02)×10⁻⁶": the value and its error with the digits that the error permits. If the
// error is not positive and finite, the value alone.
std::string with_error(double value, double sigma);

struct EmpiricalFormula {
  std::string text;  // with standard errors of its constants; empty if there is no short formula
  std::string looks_like;  // weak evidence: physics that commonly has this form
};

// `parameters` are the fitted ones of empirical_torque(shape); `covariance` is theirs in SI units,
// in equal order. The text omits components below three standard errors, except for the largest.
EmpiricalFormula formula_of(const EmpiricalShape& shape,
                            const std::vector<FittedParameter>& parameters,
                            const Eigen::MatrixXd& covariance);

// The empirical parts of a trial along its first run: means over bins of the variable, with
// standard errors from the covariance of the coefficients.
std::vector<EmpiricalTorque> empirical_torques(const Trial& chosen, const Candidates& all,
                                               const std::vector<Observation>& runs);

}  // namespace photorque
