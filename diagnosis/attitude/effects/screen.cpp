// Score tests of disturbances that a model lacks, and the linear problem of their strengths.
#include <cmath>

#include "attitude/estimation/fit.h"
#include "diagnosis/attitude/effects/scan.h"

namespace photorque {
namespace {

constexpr size_t variables_at_once = 72;

std::vector<int> parameters_of(const ScoreGroup& group, const Disturbance& d) {
  if (!group.parameters.empty()) return group.parameters;
  std::vector<int> all;
  for (size_t p = 0; p < d.parameters.size(); ++p) all.push_back(static_cast<int>(p));
  return all;
}

// Information of the data about the parameters of some groups, with all fitted parameters and the
// initial values of the groups' states projected out.
struct GroupsAtFit {
  inference::Projected all;
  std::vector<Eigen::Index> begin;  // index of each group's first parameter, and the end
  bool known = false;               // false: propagation failed
};

GroupsAtFit project(const Fit& at, const std::vector<Observation>& runs,
                    const std::vector<ScoreGroup>& groups, size_t first, size_t last) {
  GroupsAtFit result;
  Hypothesis h = at.best;
  std::vector<Free> extra;
  for (size_t g = first; g < last; ++g) {
    result.begin.push_back(static_cast<Eigen::Index>(extra.size()));
    for (const Disturbance& d : groups[g].disturbances) {
      // A disturbance without parameters would change the model itself.
      if (d.parameters.empty()) continue;
      const size_t index = add_disturbance(h, d);
      for (const int p : parameters_of(groups[g], d)) extra.push_back({index, p});
    }
  }
  const auto count = static_cast<Eigen::Index>(extra.size());
  result.begin.push_back(count);
  const inference::SumsOfRuns sums = sums_at(h, runs, extra);
  if (!std::isfinite(sums.chi2)) return result;
  result.all = inference::project_out(sums, sums.matrix.size() - count);
  result.known = true;
  return result;
}

// The strengths of a candidate as a group; adds their columns in the sums to `columns`.
inference::StrengthGroup group_of(const Candidate& c, size_t term,
                                  const std::vector<SharedParameter>& numbers,
                                  std::vector<Eigen::Index>& columns) {
  inference::StrengthGroup group;
  group.term = term;
  group.name = c.name;
  group.is_empirical = c.is_empirical;
  group.first = static_cast<Eigen::Index>(columns.size());
  for (const auto& [disturbance, p, column, value] : numbers) {
    if (!c.is_strength(p)) continue;
    columns.push_back(column);
    group.value.push_back(value);
    group.scale.push_back(c.scale[p]);
    group.lowest.push_back(c.lowest[p]);
    group.highest.push_back(c.highest[p]);
  }
  return group;
}

// Sets the strengths to zero, including those found by a scan, because the derivatives are
// evaluated at zero strength.
Disturbance without_strength(const Candidate& c, Disturbance d) {
  for (size_t p = 0; p < c.scale.size(); ++p) {
    if (c.is_strength(p)) d.parameters[p].value = 0.0;
  }
  return d;
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

inference::LinearProblem Candidates::linear_problem(const Trial& at, const Terms& terms,
                                                    const Runs& runs) const {
  Hypothesis h = at.fit.best;
  std::vector<Free> extra;
  std::vector<inference::StrengthGroup> groups;
  std::vector<Eigen::Index> columns;
  // Columns of the shared sums: those of h.free in their order, then the extra ones.
  auto next = static_cast<Eigen::Index>(h.shared().size());
  for (size_t t = 0; t < terms.size(); ++t) {
    const Candidate& c = list[terms[t].candidate];
    if (c.is_fast || !c.has_strength) continue;
    std::vector<SharedParameter> numbers;
    if (t < at.candidates.size()) {
      numbers = fitted_numbers(at, t);
    } else {
      const size_t index = add_disturbance(h, without_strength(c, terms[t].start.disturbance));
      for (size_t p = 0; p < c.scale.size(); ++p) {
        if (!c.is_strength(p)) continue;
        numbers.push_back({index, p, next++, 0.0});
        extra.push_back({index, static_cast<int>(p)});
      }
    }
    groups.push_back(group_of(c, t, numbers, columns));
  }
  const inference::SumsOfRuns sums = sums_at(h, runs, extra);
  if (!std::isfinite(sums.chi2)) return {};
  inference::Projected all = inference::project_onto(sums.of_shared(), columns);
  return {std::move(all.information), std::move(all.gradient),
          sums.matrix.shared().diagonal()(columns), std::move(groups)};
}

}  // namespace photorque
