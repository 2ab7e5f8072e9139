// Light and power as a domain of the search for missing effects (inference/domain.h).
#include <algorithm>
#include <cmath>

#include "diagnosis/light/scan.h"
#include "inference/estimator/score.h"
#include "inference/whiteness.h"

namespace photorque {
namespace {

static_assert(inference::Domain<LightCandidates>);

// Normal sums over all recordings, for the trial and the further terms `more`.
inference::NormalSums sums_of(const LightTrial& at, const LightCandidates& all,
                              const LightCandidates::Terms& more,
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

}  // namespace

LightTrial LightCandidates::extend(const Trial& parent, size_t candidate, const Start& start,
                                   const Runs& runs, const Effort& effort) const {
  // The interval of a trapped tracker is computed from the recordings instead of fitted.
  const bool is_trapped = list[candidate].kind.scan == LightEffectKind::Scan::trapped;
  const std::vector<double> x = is_trapped ? trapped_interval(parent, *this, runs) : start.x;
  return fit(with_candidate(parent, candidate, x), runs, effort.max_iterations);
}

LightTrial LightCandidates::refit(const Trial& trial, const Runs& runs, const std::vector<Begin>&,
                                  const Effort& effort) const {
  return fit(trial, runs, effort.max_iterations);
}

LightTrial LightCandidates::refit_near(const Trial& trial, const Trial& other, const Runs& runs,
                                       const Effort& effort) const {
  Trial near = trial;
  near.priors = other.priors;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const auto equal = std::ranges::find(other.candidates, trial.candidates[i]);
    if (equal == other.candidates.end()) continue;
    near.x[i] = other.x[static_cast<size_t>(equal - other.candidates.begin())];
  }
  return fit(near, runs, effort.max_iterations);
}

std::vector<LightCandidates::Begin> LightCandidates::initial_conditions_of(
    const Trial& trial) const {
  return std::vector<Begin>(trial.fit.run_chi2.size());
}

LightTrial LightCandidates::with_initial_conditions(Trial trial, const std::vector<Begin>&) const {
  return trial;
}

std::vector<double> LightCandidates::gains(const Trial& at, const std::vector<size_t>& candidates,
                                           const Runs& runs) const {
  Terms more;
  for (const size_t c : candidates) {
    if (list[c].is_linear) more.push_back({c, start_of(c)});
  }
  const inference::NormalSums sums = sums_of(at, *this, more, runs);
  const inference::Projected projected = inference::project_out(sums, fitted_numbers(at, *this));
  std::vector<double> gains;
  Eigen::Index first = 0;
  for (const size_t c : candidates) {
    if (!list[c].is_linear) {
      gains.push_back(0.0);
      continue;
    }
    const auto count = static_cast<Eigen::Index>(list[c].parameters);
    gains.push_back(projected.score(first, count).gain);
    first += count;
  }
  return gains;
}

LightCandidates::Terms LightCandidates::terms_of(const Trial& trial) const {
  Terms terms;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    terms.push_back({trial.candidates[i], {trial.x[i]}});
  }
  return terms;
}

inference::LinearProblem LightCandidates::linear_problem(const Trial& at, const Terms& terms,
                                                         const Runs& runs) const {
  const size_t own = at.candidates.size();
  const Terms more(terms.begin() + static_cast<std::ptrdiff_t>(own), terms.end());
  const inference::NormalSums sums = sums_of(at, *this, more, runs);
  if (!std::isfinite(sums.chi2) || !sums.matrix.allFinite()) return {};
  inference::LinearProblem problem;
  std::vector<Eigen::Index> columns;
  // Columns of the sums: the priors, the fitted numbers of the trial, the strengths of more terms.
  auto next = static_cast<Eigen::Index>(at.priors.size());
  for (size_t t = 0; t < terms.size(); ++t) {
    const LightCandidate& c = list[terms[t].candidate];
    inference::StrengthGroup group;
    group.term = t;
    group.name = c.name;
    group.is_empirical = c.is_empirical;
    group.first = static_cast<Eigen::Index>(columns.size());
    for (size_t k = 0; k < c.numbers.size(); ++k) {
      const LightCandidate::Number& n = c.numbers[k];
      if (!(t < own ? n.is_fitted : n.is_strength)) continue;
      const Eigen::Index column = next++;
      if (!n.is_strength) continue;
      columns.push_back(column);
      group.value.push_back(t < own ? at.x[t][k] : 0.0);
      group.scale.push_back(n.scale);
      // Forecasts overshoot where the model is nonlinear, and the fit enforces the bounds, so only
      // signs are required here.
      group.lowest.push_back(n.lowest == 0.0 ? 0.0 : -inference::infinity);
      group.highest.push_back(n.highest == 0.0 ? 0.0 : inference::infinity);
    }
    if (group.count() > 0) problem.groups.push_back(std::move(group));
  }
  inference::Projected projected = inference::project_onto(sums, columns);
  problem.information = std::move(projected.information);
  problem.gradient = std::move(projected.gradient);
  return problem;
}

LightTrial LightCandidates::assemble(const Trial& from, const inference::Members<Start>& members,
                                     const Runs& runs, const Effort& effort) const {
  Trial plain, predicted;
  plain.priors = from.priors;
  for (const inference::Member<Start>& member : members) {
    plain = with_candidate(std::move(plain), member.term.candidate, member.term.start.x);
  }
  predicted = plain;
  for (size_t m = 0; m < members.size(); ++m) {
    const inference::Member<Start>& member = members[m];
    const LightCandidate& c = list[member.term.candidate];
    Eigen::Index k = 0;
    for (size_t n = 0; n < c.numbers.size() && member.strengths.size() > 0; ++n) {
      if (!c.numbers[n].is_strength) continue;
      predicted.x[m][n] =
          std::clamp(member.strengths[k++], c.numbers[n].lowest, c.numbers[n].highest);
    }
  }
  // The fit starts from the forecast and, if the result is worse than before, from the present
  // values: from a forecast far off it may diverge.
  Trial trial = fit(predicted, runs, effort.max_iterations);
  const bool is_worse = !(trial.fit.chi2 < from.fit.chi2);
  if (is_worse && predicted.x != plain.x) {
    Trial other = fit(plain, runs, effort.max_iterations);
    if (other.log_evidence > trial.log_evidence) trial = std::move(other);
  }
  return trial;
}

std::vector<FittedRun> LightCandidates::average(const Trial&, const Runs& runs,
                                                size_t count) const {
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
    result.push_back(part_of(run, rows, nominal));
  }
  return result;
}

double LightCandidates::excess_sigma(const Trial& trial, const Runs& runs) const {
  double chi2 = 0.0, samples = 0.0;
  std::vector<inference::ChannelResiduals> ordered;
  for (const FittedRun& run : runs) {
    const Eigen::VectorXd r = residuals_of(trial, *this, run);
    chi2 += r.squaredNorm();
    samples += static_cast<double>(r.size());
    for (auto& channel : in_order_of_place(*run.run, r)) ordered.push_back({std::move(channel)});
  }
  if (!std::isfinite(chi2)) return limits.noise.excess_unknown;
  double excess = 0.0;
  for (const size_t neighbours : {limits.noise.neighbours / 4, limits.noise.neighbours}) {
    Thresholds::Noise scale = limits.noise;
    scale.neighbours = neighbours;
    excess = std::max(excess, inference::whiteness(ordered, scale).excess_sigma);
  }
  // The noise level is known to a few per cent; a larger χ² counts as excess.
  constexpr double known_to = 0.06;
  return std::max(excess, (chi2 / samples - 1.0 - known_to) / std::sqrt(2.0 / samples));
}

}  // namespace photorque
