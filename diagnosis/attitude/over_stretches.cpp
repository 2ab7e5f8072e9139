#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "attitude/estimation/fit.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/propagation/run.h"
#include "core/parallel.h"
#include "diagnosis/attitude/answer.h"
#include "diagnosis/attitude/holdout.h"
#include "inference/whiteness.h"

namespace photorque {
namespace {

// Stretches are dealt out so many ways: each time one part is predicted from the others.
constexpr size_t parts = 5;

struct Dealt {
  std::vector<Observation> train, held;
  std::vector<size_t> held_at;  // among all
};

std::vector<Dealt> deal(const std::vector<Observation>& all) {
  std::vector<Dealt> dealt(parts);
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t part = 0; part < parts; ++part) {
      if (i % parts != part) {
        dealt[part].train.push_back(all[i]);
        continue;
      }
      dealt[part].held.push_back(all[i]);
      dealt[part].held_at.push_back(i);
    }
  }
  return dealt;
}

// One explanation fitted to each dealt train part.
struct Predicted {
  std::vector<double> chi2;                     // of every stretch, predicted from the others
  std::vector<std::vector<double>> parameters;  // of each part: the candidate's
  std::string objection;
};

void predict_part(const Trial& trial, const Dealt& part, const Thresholds& limits,
                  Predicted& result) {
  const Fit held = propagate_model(trial.fit, part.held, limits);
  for (size_t i = 0; i < part.held.size(); ++i) {
    result.chi2[part.held_at[i]] =
        std::isfinite(held.chi2) ? held.run_chi2[i] : inference::infinity;
  }
}

std::vector<double> values_of(const Trial& trial) {
  std::vector<double> values;
  const Disturbance& d = trial.fit.best.model.disturbances[trial.disturbances.front()];
  for (const Parameter& p : d.parameters) values.push_back(p.value);
  return values;
}

// The errors of a fit widened to those by which the fits to the dealt parts differ: the jackknife
// (B. Efron, C. Stein, Annals of Statistics 9 (1981) 586). What is left over is correlated in ways
// that no noise model has.
double widening(const Trial& trial, const Predicted& predicted, const Candidate& c) {
  const Eigen::MatrixXd covariance = trial.fit.shared_posterior();
  const std::vector<Eigen::Index> where = shared_indices(trial, 0);
  const auto n = static_cast<double>(predicted.parameters.size());
  double widest = 1.0;
  size_t k = 0;
  for (size_t p = 0; p < c.scale.size(); ++p) {
    if (!c.is_fitted(p)) continue;
    const Eigen::Index at = where[k++];
    double mean = 0.0, square = 0.0;
    for (const auto& values : predicted.parameters) mean += values[p] / n;
    for (const auto& values : predicted.parameters) square += std::pow(values[p] - mean, 2);
    const double own = std::sqrt(std::max(0.0, covariance(at, at)));
    if (own > 0.0) widest = std::max(widest, std::sqrt((n - 1.0) / n * square) / own);
  }
  return widest;
}

std::string sentence_of(const std::string& name, const Predicted& named, const Predicted& nominal,
                        double sigma) {
  size_t better = 0;
  for (size_t i = 0; i < named.chi2.size(); ++i) better += named.chi2[i] < nominal.chi2[i] ? 1 : 0;
  char text[200];
  std::snprintf(text, sizeof text,
                "%s predicts %zu of %zu stretches better than the nominal model, each from fits to "
                "others (%.1f sigma by their ranks)",
                name.c_str(), better, named.chi2.size(), sigma);
  return text;
}

void use_noise(const NoiseLevels& noise, std::vector<Observation>& all) {
  for (Observation& seen : all) seen.noise = noise;
}

// Everything that is predicted by one candidate, or by none.
class Contest {
 public:
  Contest(const NominalModel& nominal, const std::vector<Observation>& all,
          const DiagnoseOptions& options)
      : options_(options), dealt_(deal(all)) {
    for (const Dealt& part : dealt_) {
      bases_.push_back(fit_nominal(nominal, part.train, options.limits));
    }
    nominal_.chi2.assign(all.size(), inference::infinity);
  }

  void enter(const Candidates& all) {
    for (size_t part = 0; part < parts; ++part) {
      predict_part(nominal_trial(bases_[part], all), dealt_[part], options_.limits, nominal_);
    }
    named_.resize(all.size());
    parallel_for(all.size(), options_.threads, [&](size_t c) {
      Predicted& own = named_[c];
      own.chi2 = nominal_.chi2;
      for (size_t part = 0; part < parts && own.objection.empty(); ++part) {
        const Trial trial =
            extend(nominal_trial(bases_[part], all), all, c, all[c].start, dealt_[part].train, {});
        own.objection = trial.objection;
        if (!own.objection.empty()) break;
        own.parameters.push_back(values_of(trial));
        predict_part(trial, dealt_[part], options_.limits, own);
      }
    });
  }

  const Predicted& nominal() const { return nominal_; }
  const Predicted& named(size_t c) const { return named_[c]; }
  // By how many standard errors the ranks say that `c` predicts better; 0 where it is forbidden.
  double over_nominal(size_t c) const { return sigma(nominal_, named_[c]); }
  double over(size_t c, size_t other) const { return sigma(named_[other], named_[c]); }

 private:
  static double sigma(const Predicted& worse, const Predicted& better) {
    if (!better.objection.empty()) return 0.0;
    std::vector<double> gains;
    for (size_t i = 0; i < worse.chi2.size(); ++i) gains.push_back(worse.chi2[i] - better.chi2[i]);
    return inference::signed_rank_sigma(gains);
  }

  const DiagnoseOptions& options_;
  std::vector<Dealt> dealt_;
  std::vector<Fit> bases_;
  Predicted nominal_;
  std::vector<Predicted> named_;
};

size_t count_fitted(const Candidate& c) {
  size_t count = 0;
  for (size_t p = 0; p < c.scale.size(); ++p) count += c.is_fitted(p) ? 1 : 0;
  return count;
}

// The candidate that predicts best, or, of those that are not told from it, the simplest.
std::optional<size_t> winner(const Contest& contest, const Candidates& all,
                             const Thresholds::OverStretches& limits) {
  std::optional<size_t> best;
  for (size_t c = 0; c < all.size(); ++c) {
    if (contest.over_nominal(c) < limits.min_sigma) continue;
    if (!best || contest.over_nominal(c) > contest.over_nominal(*best)) best = c;
  }
  if (!best) return best;
  const size_t first = *best;
  for (size_t c = 0; c < all.size(); ++c) {
    const bool is_rival = contest.over_nominal(c) >= limits.min_sigma &&
                          contest.over(first, c) < limits.min_rival_sigma;
    if (is_rival && count_fitted(all[c]) < count_fitted(all[*best])) best = c;
  }
  return best;
}

}  // namespace

std::optional<Answer> named_over_stretches(const NominalModel& nominal, RecordedData data,
                                           const DiagnoseOptions& options) {
  const Thresholds::OverStretches& limits = options.limits.over_stretches;
  std::vector<Observation> all = data.train;
  all.insert(all.end(), data.held.begin(), data.held.end());
  if (all.size() < limits.min_stretches) return std::nullopt;
  std::sort(all.begin(), all.end(), [](const Observation& a, const Observation& b) {
    return a.time_s.front() < b.time_s.front();
  });
  tell(options, "naming what predicts most stretches from the others");
  const NoiseLevels own = all.front().noise;
  const Fit left_by = fit_nominal(nominal, all, options.limits);
  if (!std::isfinite(left_by.chi2)) return std::nullopt;
  const NoiseLevels noise =
      with_discrepancy(residuals_of(left_by, all), all, own, Remainder::correlated);
  for (auto* runs : {&all, &data.train, &data.held}) use_noise(noise, *runs);

  Answer a;
  a.all = all_candidates(nominal, data.train, options.limits);
  std::erase_if(a.all.list, [](const Candidate& c) {
    return c.empirical() || !c.is_linear() || c.start.stage == Stage::measurement;
  });
  Contest contest(nominal, all, options);
  contest.enter(a.all);
  const std::optional<size_t> named = winner(contest, a.all, limits);
  if (!named) return std::nullopt;

  a.trials = {nominal_trial(fit_nominal(nominal, data.train, options.limits), a.all)};
  for (size_t c = 0; c < a.all.size(); ++c) {
    Trial trial = extend(a.trials.front(), a.all, c, a.all[c].start, data.train, {});
    if (trial.objection.empty()) trial.objection = contest.named(c).objection;
    trial.log_evidence = 0.5 * contest.over_nominal(c) * std::abs(contest.over_nominal(c));
    if (c == *named) {
      a.decision.chosen = a.trials.size();
      const double by = widening(trial, contest.named(c), a.all[c]);
      const Eigen::Index size = trial.fit.hessian.size();
      trial.fit.hessian = trial.fit.hessian.scaled(Eigen::VectorXd::Constant(size, 1.0 / by));
    }
    a.trials.push_back(std::move(trial));
  }
  a.trials.front().log_evidence = 0.0;
  for (Trial& trial : a.trials) {
    const double held = propagate_model(trial.fit, data.held, options.limits).chi2_per_sample();
    if (std::isfinite(held)) trial.holdout_chi2_per_sample = held;
  }
  a.decision.finding = inference::Finding::named;
  a.decision.best_named = a.decision.chosen;
  // Of as many tries as there are candidates.
  const double sigma = contest.over_nominal(*named);
  const double by_chance = 0.5 * std::erfc(sigma / std::sqrt(2.0));
  a.decision.confidence = std::max(0.0, 1.0 - static_cast<double>(a.all.size()) * by_chance);
  a.decision.probability.assign(a.trials.size(), 0.0);
  a.decision.probability.front() = 1.0 - a.decision.confidence;
  a.decision.probability[a.decision.chosen] = a.decision.confidence;
  a.decision.because =
      sentence_of(a.all[*named].label, contest.named(*named), contest.nominal(), sigma);
  return a;
}

}  // namespace photorque
