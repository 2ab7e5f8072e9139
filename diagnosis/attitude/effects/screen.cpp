#include "diagnosis/attitude/effects/screen.h"

#include <cmath>

#include "attitude/estimation/nominal_model.h"

namespace photorque {
namespace {

constexpr size_t variables_at_once = 72;

std::vector<int> parameters_of(const ScoreGroup& group, const Disturbance& d) {
  if (!group.parameters.empty()) return group.parameters;
  std::vector<int> all;
  for (size_t p = 0; p < d.parameters.size(); ++p) all.push_back(static_cast<int>(p));
  return all;
}

// What the data say about the parameters of some groups, everything fitted (and the starts of the
// groups' own states) projected out.
struct GroupsAtFit {
  inference::Projected all;
  std::vector<Eigen::Index> begin;  // of each group's parameters, and the end
  bool known = false;               // false: it could not be propagated
};

GroupsAtFit project(const Fit& at, const std::vector<Observation>& runs,
                    const std::vector<ScoreGroup>& groups, size_t first, size_t last) {
  GroupsAtFit result;
  Hypothesis h = at.best;
  std::vector<Free> extra;
  for (size_t g = first; g < last; ++g) {
    result.begin.push_back(static_cast<Eigen::Index>(extra.size()));
    for (const Disturbance& d : groups[g].disturbances) {
      // It would act at once.
      if (d.parameters.empty()) continue;
      const size_t index = add_disturbance(h, d);
      for (const int p : parameters_of(groups[g], d)) extra.push_back({index, p});
    }
  }
  const auto count = static_cast<Eigen::Index>(extra.size());
  result.begin.push_back(count);
  const inference::NormalSums sums = sums_at(h, runs, extra);
  if (!std::isfinite(sums.chi2)) return result;
  result.all = inference::project_out(sums, sums.matrix.rows() - count);
  result.known = true;
  return result;
}

}  // namespace

std::vector<Score> score(const Fit& at, const std::vector<Observation>& runs,
                         const std::vector<ScoreGroup>& groups) {
  std::vector<Score> scores(groups.size());
  const auto size = [&](size_t g) {
    size_t count = 0;
    for (const Disturbance& d : groups[g].disturbances) {
      count += parameters_of(groups[g], d).size();
    }
    return count;
  };
  for (size_t first = 0; first < groups.size();) {
    size_t last = first + 1, count = size(first);
    while (last < groups.size() && count + size(last) <= variables_at_once) count += size(last++);
    const GroupsAtFit these = project(at, runs, groups, first, last);
    for (size_t g = first; these.known && g < last; ++g) {
      const Eigen::Index a = these.begin[g - first], n = these.begin[g - first + 1] - a;
      scores[g] = these.all.score(a, n);
    }
    first = last;
  }
  return scores;
}

Eigen::MatrixXd score_pairs(const Fit& at, const std::vector<Observation>& runs,
                            const std::vector<ScoreGroup>& groups) {
  const GroupsAtFit these = project(at, runs, groups, 0, groups.size());
  if (these.known) return inference::pair_gains(these.all, these.begin);
  const auto count = static_cast<Eigen::Index>(groups.size());
  return Eigen::MatrixXd::Zero(count, count);
}

}  // namespace photorque
