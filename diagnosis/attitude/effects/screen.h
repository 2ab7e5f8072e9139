// Score tests (inference/estimator/score.h) of disturbances that a model lacks.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "inference/estimator/score.h"
#include "inference/subsets.h"

namespace photorque {

using inference::Score;
using inference::solve_score;

// A group of parameters that are added together.
struct ScoreGroup {
  std::vector<Disturbance> disturbances;
  std::vector<int> parameters = {};  // indices in each disturbance; empty: all
};

// Scores all groups in one pass, or in several to limit memory. A group that cannot be propagated
// has gain 0.
std::vector<Score> score(const Fit& at, const std::vector<Observation>& runs,
                         const std::vector<ScoreGroup>& groups);

// The linear problem of the strengths of terms about a trial (inference/subsets.h). All other
// fitted parameters are projected out. The first `terms` are those of the trial. Fast effects are
// omitted. All parameters are evaluated in one pass, for runs of some thousand blocks.
inference::LinearProblem linear_problem(const Trial& at, const Candidates& all,
                                        const std::vector<inference::Term<Start>>& terms,
                                        const std::vector<Observation>& runs);

}  // namespace photorque
