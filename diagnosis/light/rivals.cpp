#include "diagnosis/light/findings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/numerics/linear.h"
#include "core/parallel.h"

namespace photorque {
namespace {

// For the effect of the first of `terms` with the numbers x: the part of its χ² that the strengths
// of each other term cannot reproduce. The first entry is the χ² of the whole effect.
Eigen::VectorXd distinct_chi2(const LightTrial& about, const LightCandidates& all,
                              const LightCandidates::Terms& terms,
                              const std::vector<FittedRun>& runs, const std::vector<double>& x) {
  Eigen::MatrixXd H;
  for (const FittedRun& run : runs) {
    const LightSlopes s = slopes_of(about, all, terms, run);
    const Eigen::MatrixXd square = s.slopes.transpose() * s.slopes;
    H = H.size() == 0 ? square : Eigen::MatrixXd(H + square);
  }
  const Eigen::Index fitted = fitted_numbers(about, all);
  if (fitted > 0) {
    const Eigen::MatrixXd inner = H.topLeftCorner(fitted, fitted),
                          cross = H.bottomLeftCorner(H.rows() - fitted, fitted);
    H = Eigen::MatrixXd(H.bottomRightCorner(H.rows() - fitted, H.cols() - fitted) -
                        cross * solve_symmetric(inner, cross.transpose()));
  }
  std::vector<double> strengths;
  const LightCandidate& named = all[terms.front().candidate];
  for (size_t k = 0; k < named.numbers.size(); ++k) {
    if (named.numbers[k].is_strength) strengths.push_back(x[k]);
  }
  const auto own = static_cast<Eigen::Index>(strengths.size());
  const Eigen::Map<const Eigen::VectorXd> theta(strengths.data(), own);
  Eigen::VectorXd left(static_cast<Eigen::Index>(terms.size()));
  left[0] = own > 0 ? theta.dot(H.topLeftCorner(own, own) * theta) : 0.0;
  Eigen::Index at = own;
  for (size_t t = 1; t < terms.size(); ++t) {
    const LightCandidate& c = all[terms[t].candidate];
    const auto n = static_cast<Eigen::Index>(
        std::ranges::count_if(c.numbers, [](const auto& number) { return number.is_strength; }));
    left[static_cast<Eigen::Index>(t)] = left[0];
    if (n > 0 && own > 0) {
      const double taken = linear_gain(H.block(at, at, n, n), H.block(at, 0, n, own) * theta);
      if (std::isfinite(taken)) left[static_cast<Eigen::Index>(t)] -= taken;
    }
    at += n;
  }
  return left;
}

// Like distinct_chi2(), for an effect without parameters whose fit is `own`: excess of χ² over that
// fit if each of `others` replaces the effect.
Eigen::VectorXd distinct_chi2_of_switch(const LightTrial& own, const LightTrial& without,
                                        const LightCandidates& all,
                                        const std::vector<size_t>& others,
                                        const std::vector<FittedRun>& runs) {
  const LightTrial bare = all.fit(without, runs, 25);
  const std::vector<double> gains = all.gains(bare, others, runs);
  const double whole = bare.fit.chi2 - own.fit.chi2;
  Eigen::VectorXd left(static_cast<Eigen::Index>(others.size()) + 1);
  left[0] = whole;
  for (size_t k = 0; k < others.size(); ++k) {
    left[static_cast<Eigen::Index>(k) + 1] = whole - gains[k];
  }
  return left;
}

}  // namespace

std::vector<inference::Checks::Place> other_light_places(const LightTrial& trial, size_t which,
                                                         const LightCandidates& all,
                                                         const std::vector<FittedRun>& runs,
                                                         int threads) {
  const LightCandidate& named = all[trial.candidates[which]];
  std::vector<inference::Checks::Place> places;
  if (!named.kind.is_numbered()) return places;
  for (size_t i = 0; i < all.list.size(); ++i) {
    const bool is_free = std::ranges::find(trial.candidates, i) == trial.candidates.end();
    if (is_free && all[i].kind.name == named.kind.name) places.emplace_back(i, 0.0);
  }
  constexpr int iterations = 12;
  const LightTrial own = all.fit(trial, runs, iterations);
  parallel_for(places.size(), threads, [&](size_t k) {
    LightTrial there = trial;
    there.candidates[which] = places[k].first;
    places[k].second = own.log_evidence - all.fit(there, runs, iterations).log_evidence;
  });
  return places;
}

std::vector<std::string> light_rivals(const LightAnswer& answer, size_t which,
                                      const std::vector<FittedRun>& runs) {
  const LightTrial& chosen = answer.chosen();
  const LightCandidates& all = answer.all;
  const LightTrial without = without_candidate(chosen, which);
  const double within = all.limits.search.min_log_evidence_gain;
  const LightTrial own = all.fit(chosen, runs, 25);
  const LightCandidate& named = all[chosen.candidates[which]];
  std::vector<size_t> others;
  LightCandidates::Terms terms = {{chosen.candidates[which], {chosen.x[which]}}};
  for (size_t i = 0; i < all.list.size(); ++i) {
    const LightCandidate& c = all[i];
    if (c.is_empirical || c.kind.name == named.kind.name || !(c.is_linear || c.parameters == 0))
      continue;
    if (c.kind.index == named.kind.index && c.index != named.index) continue;
    others.push_back(i);
    terms.push_back({i, {c.start()}});
  }
  const Eigen::VectorXd left = named.has_strength
                                   ? distinct_chi2(without, all, terms, runs, chosen.x[which])
                                   : distinct_chi2_of_switch(own, without, all, others, runs);
  std::set<std::string> rivals;
  for (size_t k = 0; k < others.size(); ++k) {
    const LightCandidate& c = all[others[k]];
    // Limit of the irreproducible χ². It grows with the gain, because χ² is of first order but
    // large effects are nonlinear.
    constexpr double beyond = 10.0, of_all = 0.02;
    const double gain = left[0];
    if (left[static_cast<Eigen::Index>(k) + 1] > beyond * within + of_all * gain) continue;
    if (rivals.contains(c.kind.name)) continue;
    const LightTrial rival = all.fit(with_candidate(without, others[k], c.start()), runs, 25);
    if (rival.log_evidence > own.log_evidence - within) rivals.insert(c.kind.name);
  }
  // Adds the candidates that explain the recordings equally well in its place.
  for (const LightTrial& t : answer.trials) {
    if (t.candidates.size() != chosen.candidates.size()) continue;
    if (!(t.log_evidence > chosen.log_evidence - within) || !t.objection.empty()) continue;
    std::vector<size_t> rest = t.candidates;
    for (const size_t other : without.candidates) std::erase(rest, other);
    if (rest.size() != 1) continue;
    const LightCandidate& c = all[rest.front()];
    const bool is_elsewhere = c.kind.index == named.kind.index && c.index != named.index;
    if (!c.is_empirical && !is_elsewhere && c.kind.name != named.kind.name) {
      rivals.insert(c.kind.name);
    }
  }
  return {rivals.begin(), rivals.end()};
}

}  // namespace photorque
