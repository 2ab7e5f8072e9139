#include "inference/subsets.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "inference/estimator/covariance.h"
#include "inference/estimator/evidence.h"

namespace photorque::inference {
namespace {

class Forecast {
 public:
  Forecast(const LinearProblem& problem, const Thresholds& limits)
      : problem_(problem), limits_(limits) {
    const Eigen::Index n = problem.gradient.size();
    // Scales to a unit diagonal: the units of the parameters differ by any number of orders.
    unit_ = inverse_roots(problem.information.diagonal(), 0.0);
    matrix_ = unit_.asDiagonal() * problem.information * unit_.asDiagonal();
    for (Eigen::Index i = 0; i < n; ++i) {
      const double raw = problem.before.size() == n ? problem.before[i] * unit_[i] * unit_[i] : 1.0;
      matrix_(i, i) += rounding * std::max(1.0, raw);
    }
    gradient_ = unit_.cwiseProduct(problem.gradient);
    value_ = Eigen::VectorXd::Zero(n);
    for (const StrengthGroup& group : problem.groups) {
      for (Eigen::Index k = 0; k < group.count(); ++k) {
        const Eigen::Index i = group.first + k;
        const double v = group.value[static_cast<size_t>(k)];
        value_[i] = unit_[i] > 0.0 ? v / unit_[i] : 0.0;
      }
    }
    // Gradient and gain at the point where all strengths are zero.
    gradient_without_ = gradient_ + matrix_ * value_;
    gain_without_ = -2.0 * gradient_.dot(value_) - value_.dot(matrix_ * value_);
  }

  // Predicted gain of the groups, which ranks the sets.
  double gain(const std::vector<size_t>& groups) const {
    if (groups.empty()) return gain_without_;
    const std::vector<Eigen::Index> at = places(groups);
    const Eigen::VectorXd g = gradient_without_(at);
    return gain_without_ + g.dot(matrix_(at, at).llt().solve(g));
  }

  // Forecast for the groups, computed from zero strengths: θ_S = H_SS⁻¹ (g + H θ)_S. The evidence
  // is −∞ if physics forbids the strengths.
  Subset subset(const std::vector<size_t>& groups) const {
    Subset result{groups, gain_without_, 0.0, {}};
    const std::vector<Eigen::Index> at = places(groups);
    const auto n = static_cast<Eigen::Index>(at.size());
    Strengths strengths;
    Eigen::MatrixXd covariance(n, n);
    if (n > 0) {
      const Eigen::VectorXd g = gradient_without_(at), unit = unit_(at);
      const Eigen::LLT<Eigen::MatrixXd> llt(matrix_(at, at));
      const Eigen::VectorXd scaled = llt.solve(g);
      result.gain += g.dot(scaled);
      result.value = unit.cwiseProduct(scaled);
      covariance =
          unit.asDiagonal() * llt.solve(Eigen::MatrixXd::Identity(n, n)) * unit.asDiagonal();
      result.log_evidence += 0.5 * log_determinant(covariance);
    }
    Eigen::Index k = 0;
    bool is_forbidden = false;
    for (size_t owner = 0; owner < groups.size(); ++owner) {
      const StrengthGroup& group = problem_.groups[groups[owner]];
      result.log_evidence += group.is_empirical ? limits_.evidence.log_prior_empirical
                                                : limits_.evidence.log_prior_effect;
      for (size_t p = 0; p < group.value.size(); ++p, ++k) {
        strengths.at.push_back(k);
        strengths.owner.push_back(owner);
        strengths.value.push_back(result.value[k]);
        strengths.scale.push_back(group.scale[p]);
        const double beyond = limits_.objection.bound_sigma * std::sqrt(covariance(k, k));
        is_forbidden = is_forbidden || result.value[k] < group.lowest[p] - beyond ||
                       result.value[k] > group.highest[p] + beyond;
      }
    }
    result.log_evidence += 0.5 * result.gain;
    if (n > 0) {
      result.log_evidence +=
          log_strength_evidence(strengths, covariance, groups.size(), limits_.evidence);
    }
    if (is_forbidden) result.log_evidence = -std::numeric_limits<double>::infinity();
    return result;
  }

  size_t parameters(const std::vector<size_t>& groups) const { return places(groups).size(); }

  // Whether a group may be combined with the others.
  bool may_join(const std::vector<size_t>& groups, size_t group) const {
    const StrengthGroup& joining = problem_.groups[group];
    return std::none_of(groups.begin(), groups.end(), [&](size_t g) {
      const StrengthGroup& there = problem_.groups[g];
      return g == group || there.name == joining.name ||
             (there.is_empirical && joining.is_empirical);
    });
  }

  bool has_empirical(const std::vector<size_t>& groups) const {
    return std::any_of(groups.begin(), groups.end(),
                       [&](size_t g) { return problem_.groups[g].is_empirical; });
  }

  // Whether the readings do not determine some parameter of the group.
  bool is_silent(size_t group) const {
    const StrengthGroup& g = problem_.groups[group];
    return !(unit_.segment(g.first, g.count()).minCoeff() > 0.0);
  }

 private:
  // Limit of the information on a unit diagonal before projection. Combinations with less
  // information keep their values. It is above the square of the error of the derivatives, which is
  // about 1e-7.
  static constexpr double rounding = 1e-10;

  std::vector<Eigen::Index> places(const std::vector<size_t>& groups) const {
    std::vector<Eigen::Index> all;
    for (const size_t g : groups) {
      const StrengthGroup& group = problem_.groups[g];
      for (Eigen::Index k = 0; k < group.count(); ++k) all.push_back(group.first + k);
    }
    return all;
  }

  const LinearProblem& problem_;
  const Thresholds& limits_;
  Eigen::VectorXd unit_, gradient_, value_, gradient_without_;
  Eigen::MatrixXd matrix_;
  double gain_without_ = 0.0;
};

// Adds one group to each set of the beam and ranks the distinct results by gain minus the cost of
// their parameters and names.
std::vector<std::vector<size_t>> larger(const Forecast& forecast, const LinearProblem& problem,
                                        const std::vector<std::vector<size_t>>& beam,
                                        const Thresholds& limits) {
  const double name = -2.0 * limits.evidence.log_prior_effect;
  std::vector<std::pair<double, std::vector<size_t>>> ranked;
  std::set<std::vector<size_t>> seen;
  for (const std::vector<size_t>& from : beam) {
    for (size_t g = 0; g < problem.groups.size(); ++g) {
      if (!forecast.may_join(from, g) || forecast.is_silent(g)) continue;
      std::vector<size_t> set = from;
      set.insert(std::upper_bound(set.begin(), set.end(), g), g);
      if (!seen.insert(set).second) continue;
      const double cost =
          limits.scoring.cost_per_parameter * static_cast<double>(forecast.parameters(set)) +
          name * static_cast<double>(set.size());
      const double worth = forecast.gain(set) - cost;
      if (std::isfinite(worth)) ranked.emplace_back(worth, std::move(set));
    }
  }
  std::ranges::stable_sort(ranked, std::ranges::greater(), [](const auto& r) { return r.first; });
  std::vector<std::vector<size_t>> result;
  for (auto& [worth, set] : ranked) result.push_back(std::move(set));
  return result;
}

// The first `count` sets, and the first `count` sets without an empirical law. Empirical laws fit
// anything and would crowd out the parts of an explanation that gain only together.
std::vector<std::vector<size_t>> kept_of(const Forecast& forecast,
                                         std::vector<std::vector<size_t>> ranked, size_t count) {
  std::vector<std::vector<size_t>> kept;
  size_t known = 0;
  for (size_t i = 0; i < ranked.size(); ++i) {
    const bool is_known = !forecast.has_empirical(ranked[i]);
    if (i < count || (is_known && known < count)) kept.push_back(std::move(ranked[i]));
    known += is_known ? 1 : 0;
  }
  return kept;
}

}  // namespace

std::vector<Subset> best_subsets(const LinearProblem& problem, size_t max_size,
                                 const Thresholds& limits) {
  const Forecast forecast(problem, limits);
  std::vector<Subset> found = {forecast.subset({})};
  std::vector<std::vector<size_t>> beam = {{}};
  for (size_t size = 1; size <= max_size; ++size) {
    std::vector<std::vector<size_t>> sets = larger(forecast, problem, beam, limits);
    // All single candidates are kept, because any two may hide each other's gain.
    std::vector<std::vector<size_t>> kept = kept_of(forecast, sets, limits.search.beam);
    for (const std::vector<size_t>& set : kept) found.push_back(forecast.subset(set));
    beam = size == 1 ? std::move(sets) : std::move(kept);
  }
  std::erase_if(found, [](const Subset& s) { return !std::isfinite(s.log_evidence); });
  std::ranges::stable_sort(found, std::ranges::greater(), &Subset::log_evidence);
  return found;
}

}  // namespace photorque::inference
