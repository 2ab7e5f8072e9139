// Score tests: how much χ² would fall if a disturbance were added whose parameters now stand at
// zero effect, computed from slopes at the present fit alone, everything already fitted projected
// out.
#pragma once

#include "diagnosis/attitude/fit.h"

namespace photorque {

struct Score {
  double gain = 0.0;            // expected fall of χ²
  Eigen::VectorXd estimate;     // expected change of the parameters
  Eigen::MatrixXd information;  // inverse covariance of the estimate
};

// From the information S about some parameters and their gradient g: the gain gᵀ S⁻¹ g and the
// estimate S⁻¹ g in the space that the data determine at all. `before`: the diagonal of the
// information before anything was projected out.
Score solve_score(const Eigen::MatrixXd& S, const Eigen::VectorXd& g,
                  const Eigen::VectorXd& before);

// One group of parameters that would enter together.
struct ScoreGroup {
  std::vector<Disturbance> disturbances;
  std::vector<int> parameters = {};  // of each disturbance; empty: all
};

// All groups in one pass (some in several, so that memory stays bounded). A group that cannot be
// propagated has gain 0.
std::vector<Score> score(const Fit& at, const std::vector<Observation>& runs,
                         const std::vector<ScoreGroup>& groups);

// The expected fall of χ² by every two groups together, on the diagonal by each alone. In one pass
// with all their parameters: for runs of some thousand blocks.
Eigen::MatrixXd score_pairs(const Fit& at, const std::vector<Observation>& runs,
                            const std::vector<ScoreGroup>& groups);

}  // namespace photorque
