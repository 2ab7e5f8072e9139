// Score tests predict how much χ² falls if parameters that are fixed at zero effect are freed. They
// use the slopes at the present fit alone (C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50).
//
// Let f denote the fitted parameters and c the candidates in the information matrix and gradient of
// all parameters. With the fitted parameters projected out, those of the candidates are
//
//   S = H_cc − H_cf H_ff⁻¹ H_fc,   s = g_c − H_cf H_ff⁻¹ g_f.
//
// Freeing the candidates changes them by S⁻¹ s and lowers χ² by sᵀ S⁻¹ s. Both are exact for linear
// models.
#pragma once

#include <vector>

#include "inference/estimator/arrow_matrix.h"

namespace photorque::inference {

struct Score {
  double gain = 0.0;            // expected fall of χ²
  Eigen::VectorXd estimate;     // expected change of the parameters
  Eigen::MatrixXd information;  // inverse covariance of the estimate
};

// Solves for parameters with information S and gradient s, in the subspace that the data determine.
// `before`: the diagonal of the information before projection; a remainder below 1e-8 of it is
// rounding.
Score solve_score(const Eigen::MatrixXd& S, const Eigen::VectorXd& s,
                  const Eigen::VectorXd& before);

// S and s of all parameters after the first `fitted` ones, which are projected out; priors are
// included.
struct Projected {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  Eigen::VectorXd before;  // argument of solve_score()

  // Score of the parameters [first, first + count).
  Score score(Eigen::Index first, Eigen::Index count) const;
};
Projected project_out(const NormalSums& sums, Eigen::Index fitted);
// S and s of the parameters `kept`, in that order; all others are projected out.
Projected project_onto(const NormalSums& sums, const std::vector<Eigen::Index>& kept);
// Projects out the first `fitted` parameters of several runs, which include all run parameters.
Projected project_out(const SumsOfRuns& sums, Eigen::Index fitted);

}  // namespace photorque::inference
