// Predicts which candidates together explain the residual, without a fit.
//
// The problem is a quadratic form about a trial. One pass over the recordings gives the information
// matrix H and the gradient g = −½ ∂χ²/∂θ of the strengths of all candidates, both present and
// absent in the trial; all other parameters are projected out. The gain of any subset S, with the
// other candidates D of the trial removed, follows from a few products:
//
//   δ_dropped = −θ_dropped,   δ_S = H_SS⁻¹ (g_S − H_SD δ_D),   gain = 2 gᵀδ − δᵀHδ.
//
// The search therefore finds pairs, triples and quadruples whose members gain little alone, and
// exchanges a member as easily as it adds one. The forecast is valid as far as the readings are
// linear in the strengths; a fit follows.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inference/estimator/thresholds.h"

namespace photorque::inference {

// The strengths of one candidate.
struct StrengthGroup {
  size_t term = 0;   // index of the term in the problem's list of terms
  std::string name;  // two groups of one name are never combined
  bool is_empirical = false;
  Eigen::Index first = 0;               // index of its first parameter in the problem
  std::vector<double> value;            // in the trial; 0 if the trial lacks it
  std::vector<double> scale;            // expected size of each, > 0
  std::vector<double> lowest, highest;  // physical bounds

  auto count() const { return static_cast<Eigen::Index>(value.size()); }
};

struct LinearProblem {
  Eigen::MatrixXd information;  // H
  Eigen::VectorXd gradient;     // g
  // The diagonal of H before the nuisance parameters are projected out. A remainder of the size of
  // rounding is no information and must not explain anything. If empty, the diagonal of H is used.
  Eigen::VectorXd before = {};
  std::vector<StrengthGroup> groups;
};

struct Subset {
  std::vector<size_t> groups;  // in ascending order
  double gain = 0.0;           // predicted fall of χ²
  // Natural logarithm of the evidence of the linearised problem, up to a constant that is common to
  // all subsets.
  double log_evidence = 0.0;
  Eigen::VectorXd value;  // predicted strengths, group by group
};

// Subsets of at most `max_size` groups and at most one empirical group, largest evidence first.
// Subsets that physics forbids are omitted; the nominal model (no group) may be included. The beam
// search starts from the empty set.
std::vector<Subset> best_subsets(const LinearProblem& problem, size_t max_size,
                                 const Thresholds& limits);

}  // namespace photorque::inference
