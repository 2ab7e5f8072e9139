// Which candidates together explain the residual, predicted without a fit.
//
// About a trial the problem is a quadratic form: one pass over the recordings gives the information
// matrix H and the gradient g = −½ ∂χ²/∂θ of the strengths of all candidates, those that the trial
// has and those that it lacks, everything else projected out. What any subset would gain, with the
// trial's other candidates taken away, is then a matter of a few products:
//
//   δ_dropped = −θ_dropped,   δ_S = H_SS⁻¹ (g_S − H_SD δ_D),   gain = 2 gᵀδ − δᵀHδ.
//
// So pairs, triples and quadruples are searched in full where only their members' gains alone would
// hide them, and a member that only replaces another is exchanged as easily as one is added. The
// forecast holds as far as the readings are linear in the strengths; a fit follows.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inference/estimator/thresholds.h"

namespace photorque::inference {

// The strengths of one candidate.
struct StrengthGroup {
  size_t term = 0;   // which of the terms that the problem was made from
  std::string name;  // two of one name never enter together
  bool is_empirical = false;
  Eigen::Index first = 0;               // of its parameters in the problem
  std::vector<double> value;            // of each in the trial; 0 if it lacks it
  std::vector<double> scale;            // expected of each, > 0
  std::vector<double> lowest, highest;  // bounds of physics

  auto count() const { return static_cast<Eigen::Index>(value.size()); }
};

struct LinearProblem {
  Eigen::MatrixXd information;  // H
  Eigen::VectorXd gradient;     // g
  // The diagonal of H before the nuisances were projected out of it. A remainder of the size of
  // rounding is no information: with it anything could be explained. Empty: as H says.
  Eigen::VectorXd before = {};
  std::vector<StrengthGroup> groups;
};

struct Subset {
  std::vector<size_t> groups;  // rising
  double gain = 0.0;           // predicted fall of χ²
  // Of the linearised problem, natural logarithm, but for a constant that all subsets share.
  double log_evidence = 0.0;
  Eigen::VectorXd value;  // predicted strengths, group by group
};

// Subsets of at most `max_size` groups, one empirical among them at the most, without those that
// physics forbids, the largest evidence first; the nominal model (no group) may be among them. By a
// beam search from the empty set upwards.
std::vector<Subset> best_subsets(const LinearProblem& problem, size_t max_size,
                                 const Thresholds& limits);

}  // namespace photorque::inference
