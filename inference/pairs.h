// Two candidates that hide each other: alone neither may be what explains most.
#pragma once

#include "inference/extend.h"

namespace photorque::inference {

struct Pair {
  size_t first, second;  // candidates, the stronger first
  double gain;           // predicted of both together
};

// Pairs of linear candidates that would gain clearly more than the better of the two alone, but for
// those that were tried, best first.
template <Domain D>
std::vector<Pair> promising_pairs(const D& domain, const typename D::Trial& nominal,
                                  const std::vector<typename D::Run>& averages,
                                  const std::vector<typename D::Trial>& tried) {
  const std::vector<CandidateTraits>& all = domain.candidates();
  const Thresholds::Scoring& limits = domain.limits().scoring;
  std::vector<size_t> linear;
  for (size_t c = 0; c < all.size(); ++c) {
    if (!all[c].is_empirical && all[c].is_linear) linear.push_back(c);
  }
  const Eigen::MatrixXd gains = domain.pair_gains(nominal, linear, averages);
  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < gains.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < gains.cols(); ++j) {
      const auto [a, b] = gains(i, i) > gains(j, j) ? std::pair(i, j) : std::pair(j, i);
      const Pair pair{linear[static_cast<size_t>(a)], linear[static_cast<size_t>(b)], gains(i, j)};
      if (all[pair.first].name == all[pair.second].name) continue;
      if (gains(i, j) < gains(a, a) + limits.min_pair_gain) continue;
      const bool was_tried = std::any_of(tried.begin(), tried.end(), [&](const auto& t) {
        return same_candidates(t.candidates, {pair.first, pair.second});
      });
      if (!was_tried) pairs.push_back(pair);
    }
  }
  const auto worth = [&](const Pair& p) {
    const size_t parameters = all[p.first].parameters + all[p.second].parameters;
    return p.gain - limits.cost_per_parameter * static_cast<double>(parameters);
  };
  std::stable_sort(pairs.begin(), pairs.end(),
                   [&](const Pair& a, const Pair& b) { return worth(a) > worth(b); });
  return pairs;
}

// Near the readings the score test predicts what every pair would gain; the best are fitted.
template <Domain D>
std::vector<typename D::Trial> best_pairs(const D& domain, const typename D::Trial& nominal,
                                          const std::vector<typename D::Run>& runs,
                                          const std::vector<typename D::Trial>& tried,
                                          int threads) {
  using Trial = typename D::Trial;
  if (has_diverged(nominal, domain.limits())) return {};
  const std::vector<typename D::Run> averages = slow_runs<D>(domain, nominal, {runs});
  std::vector<Pair> pairs = promising_pairs(domain, nominal, averages, tried);
  pairs.resize(std::min(domain.limits().search.max_pairs, pairs.size()));
  std::vector<Trial> found(pairs.size());
  parallel_for(pairs.size(), threads, [&](size_t i) {
    const auto [a, b, gain] = pairs[i];
    const Trial one = domain.extend(nominal, a, domain.start_of(a), averages, {});
    const Trial two = domain.extend(one, b, domain.start_of(b), averages, {});
    found[i] = domain.refit(two, runs, domain.begins_of(two), {});
  });
  return found;
}

// A pair is found by way of its stronger half, which may have been another candidate that takes its
// place: the other half alone, where it has not been a parent, to be extended in turn.
template <Domain D>
std::vector<typename D::Trial> other_halves(const D& domain, const typename D::Trial& pair,
                                            const std::vector<typename D::Trial>& parents,
                                            const std::vector<typename D::Trial>& singles,
                                            const std::vector<typename D::Run>& runs) {
  std::vector<typename D::Trial> halves;
  for (const size_t candidate : pair.candidates) {
    const auto is_half = [&](const auto& t) {
      return t.candidates == std::vector<size_t>{candidate};
    };
    if (std::any_of(parents.begin(), parents.end(), is_half)) continue;
    const auto single = std::find_if(singles.begin(), singles.end(), is_half);
    if (single == singles.end()) continue;
    halves.push_back(domain.refit(*single, runs, domain.begins_of(*single), {}));
  }
  return halves;
}

}  // namespace photorque::inference
