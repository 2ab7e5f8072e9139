// Score tests: how much χ² would fall if parameters were freed that now stand at zero effect,
// computed from the slopes at the present fit alone (C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948)
// 50).
//
// Of the information matrix and gradient of all parameters, fitted ones f and candidates c,
//
//   S = H_cc − H_cf H_ff⁻¹ H_fc,   s = g_c − H_cf H_ff⁻¹ g_f
//
// is what the data say about the candidates with everything fitted projected out: freeing them
// lowers χ² by sᵀ S⁻¹ s, at the change S⁻¹ s. Both are exact where the model is linear.
#pragma once

#include <vector>

#include "inference/estimator/arrow_matrix.h"

namespace photorque::inference {

struct Score {
  double gain = 0.0;            // expected fall of χ²
  Eigen::VectorXd estimate;     // expected change of the parameters
  Eigen::MatrixXd information;  // inverse covariance of the estimate
};

// From the information S about some parameters and their gradient s, in the space that the data
// determine at all. `before`: the diagonal of the information before anything was projected out;
// a remainder below 1e-8 of it is rounding.
Score solve_score(const Eigen::MatrixXd& S, const Eigen::VectorXd& s,
                  const Eigen::VectorXd& before);

// S and s of all parameters after the first `fitted` ones of some sums (with the priors).
struct Projected {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  Eigen::VectorXd before;  // argument of solve_score()

  // Of the parameters `which` together.
  Score score(const std::vector<Eigen::Index>& which) const;
  // Of the parameters [first, first + count).
  Score score(Eigen::Index first, Eigen::Index count) const;
};
Projected project_out(const NormalSums& sums, Eigen::Index fitted);
// Projects out the first `fitted` parameters of several runs; all parameters of single runs are
// among them.
Projected project_out(const SumsOfRuns& sums, Eigen::Index fitted);

}  // namespace photorque::inference
