// Score tests (inference/estimator/score.h) of disturbances that a model does not have yet.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "inference/estimator/score.h"
#include "inference/subsets.h"

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

// The strengths of terms about a trial (inference/subsets.h), everything else that is fitted
// projected out. The first of `terms` are the trial's own; fast effects make no group. In one pass
// with all their parameters: for runs of some thousand blocks.
inference::LinearProblem linear_problem(const Trial& at, const Candidates& all,
                                        const std::vector<inference::Term<Start>>& terms,
                                        const std::vector<Observation>& runs);

}  // namespace photorque
