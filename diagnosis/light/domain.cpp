#include "diagnosis/light/domain.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/light/scan.h"
#include "inference/estimator/score.h"
#include "inference/whiteness.h"

namespace photorque {
namespace {

static_assert(inference::Domain<LightDomain>);

inference::CandidateTraits traits_of_light(const LightCandidate& c) {
  inference::CandidateTraits traits;
  traits.name = c.label;
  traits.is_empirical = c.is_empirical();
  traits.is_linear = c.is_linear() && c.has_strength();
  traits.has_strength = c.has_strength();
  traits.has_place = c.kind.scan == LightEffectKind::Scan::shadow;
  if (c.kind.index != LightEffectKind::Index::none) traits.kind_of_place = c.kind.name;
  traits.parameters = c.fitted();
  traits.is_fitted_first = c.bends;
  return traits;
}

// Normal sums over all recordings, for the trial and the further terms `more`.
inference::NormalSums sums_of(const LightTrial& at, const LightCandidates& all,
                              const std::vector<inference::Term<LightStart>>& more,
                              const std::vector<FittedRun>& runs) {
  inference::NormalSums sums;
  for (const FittedRun& run : runs) {
    const LightSlopes s = slopes_of(at, all, more, run);
    if (sums.matrix.size() == 0) {
      sums.matrix = Eigen::MatrixXd::Zero(s.slopes.cols(), s.slopes.cols());
      sums.gradient = Eigen::VectorXd::Zero(s.slopes.cols());
    }
    sums.matrix += s.slopes.transpose() * s.slopes;
    sums.gradient += s.slopes.transpose() * s.residuals;
    sums.chi2 += s.residuals.squaredNorm();
    sums.samples += s.residuals.size();
  }
  for (size_t i = 0; i < at.priors.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    sums.matrix(k, k) += 1.0;
    sums.gradient[k] -= at.priors[i];
  }
  return sums;
}

inference::StrengthGroup strengths_of(const LightCandidate& c, size_t term,
                                      const std::vector<double>* x) {
  inference::StrengthGroup group;
  group.term = term;
  group.name = c.label;
  group.is_empirical = c.is_empirical();
  for (size_t k = 0; k < c.numbers.size(); ++k) {
    const LightCandidate::Number& n = c.numbers[k];
    if (!n.is_strength) continue;
    group.value.push_back(x != nullptr ? (*x)[k] : 0.0);
    group.scale.push_back(n.scale);
    // Forecasts overshoot where the model is nonlinear, and the fit enforces the bounds, so only
    // signs are required here.
    group.lowest.push_back(n.lowest == 0.0 ? 0.0 : -inference::infinity);
    group.highest.push_back(n.highest == 0.0 ? 0.0 : inference::infinity);
  }
  return group;
}

}  // namespace

LightDomain::LightDomain(const LightCandidates& all) : all_(all) {
  for (const LightCandidate& c : all.list) traits_.push_back(traits_of_light(c));
}

// Sets numbers that are computed from the recordings instead of fitted.
LightStart LightDomain::profiled(const Trial& parent, size_t candidate, Start start,
                                 const Runs& runs) const {
  if (all_[candidate].kind.scan != LightEffectKind::Scan::trapped) return start;
  return {trapped_interval(parent, all_, runs)};
}

LightTrial LightDomain::extend(const Trial& parent, size_t candidate, const Start& start,
                               const Runs& runs, const Effort& effort) const {
  return fit_light(all_,
                   with_candidate(parent, candidate, profiled(parent, candidate, start, runs).x),
                   runs, effort.max_iterations);
}

LightTrial LightDomain::refit(const Trial& trial, const Runs& runs, const std::vector<Begin>&,
                              const Effort& effort) const {
  return fit_light(all_, trial, runs, effort.max_iterations);
}

LightTrial LightDomain::refit_near(const Trial& trial, const Trial& other, const Runs& runs,
                                   const Effort& effort) const {
  Trial near = trial;
  near.priors = other.priors;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const auto equal = std::ranges::find(other.candidates, trial.candidates[i]);
    if (equal == other.candidates.end()) continue;
    near.x[i] = other.x[static_cast<size_t>(equal - other.candidates.begin())];
  }
  return fit_light(all_, near, runs, effort.max_iterations);
}

LightTrial LightDomain::predict(const Trial& trial, const Runs& runs) const {
  return predict_light(trial, all_, runs);
}

std::vector<double> LightDomain::gains(const Trial& at, const std::vector<size_t>& candidates,
                                       const Runs& runs) const {
  std::vector<inference::Term<Start>> more;
  for (const size_t c : candidates) {
    if (traits_[c].is_linear) more.push_back({c, start_of(c)});
  }
  const inference::NormalSums sums = sums_of(at, all_, more, runs);
  const inference::Projected projected = inference::project_out(sums, fitted_numbers(at, all_));
  std::vector<double> gains;
  Eigen::Index first = 0;
  for (const size_t c : candidates) {
    if (!traits_[c].is_linear) {
      gains.push_back(0.0);
      continue;
    }
    const auto count = static_cast<Eigen::Index>(all_[c].fitted());
    gains.push_back(projected.score(first, count).gain);
    first += count;
  }
  return gains;
}

std::vector<inference::Term<LightStart>> LightDomain::terms_of(const Trial& trial) const {
  std::vector<inference::Term<Start>> terms;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    terms.push_back({trial.candidates[i], {trial.x[i]}});
  }
  return terms;
}

inference::LinearProblem LightDomain::linear_problem(
    const Trial& at, const std::vector<inference::Term<Start>>& terms, const Runs& runs) const {
  const size_t own = at.candidates.size();
  const std::vector<inference::Term<Start>> more(terms.begin() + static_cast<std::ptrdiff_t>(own),
                                                 terms.end());
  const inference::NormalSums sums = sums_of(at, all_, more, runs);
  if (!std::isfinite(sums.chi2) || !sums.matrix.allFinite()) return {};
  inference::LinearProblem problem;
  std::vector<Eigen::Index> wanted;
  const auto add = [&](inference::StrengthGroup group, const std::vector<Eigen::Index>& columns) {
    group.first = static_cast<Eigen::Index>(wanted.size());
    wanted.insert(wanted.end(), columns.begin(), columns.end());
    problem.groups.push_back(std::move(group));
  };
  Eigen::Index next = static_cast<Eigen::Index>(at.priors.size());
  for (size_t i = 0; i < own; ++i) {
    const LightCandidate& c = all_[at.candidates[i]];
    std::vector<Eigen::Index> columns;
    for (const LightCandidate::Number& n : c.numbers) {
      if (!n.is_fitted) continue;
      if (n.is_strength) columns.push_back(next);
      ++next;
    }
    if (!columns.empty()) add(strengths_of(c, i, &at.x[i]), columns);
  }
  for (size_t i = 0; i < more.size(); ++i) {
    const LightCandidate& c = all_[more[i].candidate];
    std::vector<Eigen::Index> columns;
    for (const LightCandidate::Number& n : c.numbers) {
      if (n.is_strength) columns.push_back(next++);
    }
    add(strengths_of(c, own + i, nullptr), columns);
  }
  std::vector<bool> is_wanted(static_cast<size_t>(sums.gradient.size()), false);
  for (const Eigen::Index c : wanted) is_wanted[static_cast<size_t>(c)] = true;
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < sums.gradient.size(); ++i) {
    if (!is_wanted[static_cast<size_t>(i)]) order.push_back(i);
  }
  const auto fitted = static_cast<Eigen::Index>(order.size());
  order.insert(order.end(), wanted.begin(), wanted.end());
  const inference::NormalSums sorted{sums.matrix(order, order), sums.gradient(order), sums.chi2,
                                     sums.samples};
  inference::Projected projected = inference::project_out(sorted, fitted);
  problem.information = std::move(projected.information);
  problem.gradient = std::move(projected.gradient);
  return problem;
}

LightTrial LightDomain::assemble(const Trial& from, const inference::Members<Start>& members,
                                 const Runs& runs, const Effort& effort) const {
  Trial plain, predicted;
  plain.priors = from.priors;
  for (const inference::Member<Start>& member : members) {
    plain = with_candidate(std::move(plain), member.term.candidate, member.term.start.x);
  }
  predicted = plain;
  for (size_t m = 0; m < members.size(); ++m) {
    const inference::Member<Start>& member = members[m];
    const LightCandidate& c = all_[member.term.candidate];
    Eigen::Index k = 0;
    for (size_t n = 0; n < c.numbers.size() && member.strengths.size() > 0; ++n) {
      if (!c.numbers[n].is_strength) continue;
      predicted.x[m][n] =
          std::clamp(member.strengths[k++], c.numbers[n].lowest, c.numbers[n].highest);
    }
  }
  // The fit starts from the forecast and, if the result is worse than before, from the present
  // values: from a forecast far off it may diverge.
  Trial trial = fit_light(all_, predicted, runs, effort.max_iterations);
  const bool is_worse = !(trial.fit.chi2 < from.fit.chi2);
  if (is_worse && predicted.x != plain.x) {
    Trial other = fit_light(all_, plain, runs, effort.max_iterations);
    if (other.log_evidence > trial.log_evidence) trial = std::move(other);
  }
  return trial;
}

std::vector<std::vector<LightStart>> LightDomain::starts(const Trial& parent,
                                                         const std::vector<size_t>& candidates,
                                                         const Runs& runs, const Runs&,
                                                         int threads) const {
  return starts_from_scan(parent, all_, candidates, runs, threads);
}

std::vector<FittedRun> LightDomain::average(const Trial&, const Runs& runs, size_t count) const {
  Runs result;
  for (const FittedRun& run : runs) {
    const bool over_time = run.run->recording().kind == LightRecording::Kind::run;
    const size_t every = over_time ? (run.run->rows() + count - 1) / count : 1;
    if (every <= 1) {
      result.push_back(run);
      continue;
    }
    std::vector<size_t> rows;
    for (size_t i = 0; i < run.run->rows(); i += every) rows.push_back(i);
    result.push_back(part_of(run, rows, all_.nominal));
  }
  return result;
}

double LightDomain::excess_sigma(const Trial& trial, const Runs& runs) const {
  double chi2 = 0.0, samples = 0.0;
  std::vector<inference::ChannelResiduals> ordered;
  for (const FittedRun& run : runs) {
    const Eigen::VectorXd r = residuals_of(trial, all_, run);
    chi2 += r.squaredNorm();
    samples += static_cast<double>(r.size());
    for (auto& channel : in_order_of_place(*run.run, r)) ordered.push_back({std::move(channel)});
  }
  if (!std::isfinite(chi2)) return limits().noise.excess_unknown;
  double excess = 0.0;
  for (const size_t neighbours : {limits().noise.neighbours / 4, limits().noise.neighbours}) {
    Thresholds::Noise scale = limits().noise;
    scale.neighbours = neighbours;
    excess = std::max(excess, inference::whiteness(ordered, scale).excess_sigma);
  }
  // The noise level is known to a few per cent; a larger χ² counts as excess.
  constexpr double known_to = 0.06;
  return std::max(excess, (chi2 / samples - 1.0 - known_to) / std::sqrt(2.0 / samples));
}

}  // namespace photorque
