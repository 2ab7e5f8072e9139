// Score tests (inference/estimator/score.h) of disturbances that a model does not have yet.
#pragma once

#include "attitude/estimation/fit.h"
#include "inference/estimator/score.h"

namespace photorque {

using inference::Score;
using inference::solve_score;

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
