#include "diagnosis/light/module/explain.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "core/numerics/order.h"
#include "core/parallel.h"
#include "inference/estimator/evidence.h"
#include "inference/whiteness.h"

namespace photorque {
namespace {

using Eigen::Index, Eigen::VectorXd;

// Divides a curve into segments of `block` points. The first result contains the segments for which
// `is_held` is false, the second result the others.
std::pair<ModuleRun, ModuleRun> split_curve(const ModuleRun& run, size_t block,
                                            const std::function<bool(size_t segment)>& is_held) {
  ModuleRun train = run, held = run;
  train.sweep = run.sweep.selected([&](size_t i) { return !is_held(i / block); });
  held.sweep = run.sweep.selected([&](size_t i) { return is_held(i / block); });
  return {std::move(train), std::move(held)};
}

// χ² of segments of the curves, each predicted from a fit that leaves out a fifth of the segments.
// A segment has several parts of every curve, because damage changes only a part of a curve.
std::vector<double> chi2_of_segments(const ModuleFitter& fitter, const ModuleHypothesis& h,
                                     const ModuleTrial& trial, const std::vector<ModuleRun>& runs,
                                     const Thresholds& limits) {
  constexpr size_t folds = 5, parts = 3;
  const size_t count = limits.discrepancy.segments;
  std::vector<double> chi2(count, 0.0);
  const auto block_of = [&](const ModuleRun& run) {
    return std::max<size_t>(1, run.sweep.voltage_V.size() / (count * parts));
  };
  for (size_t fold = 0; fold < folds; ++fold) {
    std::vector<ModuleRun> rest;
    for (const ModuleRun& run : runs) {
      rest.push_back(split_curve(run, block_of(run), [&](size_t segment) {
                       return segment % count % folds == fold;
                     }).first);
    }
    const ModuleTrial others = fitter.fit(h, rest, &trial.shared);
    for (size_t run = 0; run < runs.size(); ++run) {
      const VectorXd r = fitter.residuals(h, ModuleFitter::numbers_of(others, run), runs[run]);
      for (Index i = 0; i < r.size(); ++i) {
        const size_t segment = static_cast<size_t>(i) / block_of(runs[run]) % count;
        if (segment % folds == fold) chi2[segment] += r[i] * r[i];
      }
    }
  }
  return chi2;
}

// Excess of a fit over noise [standard errors]: the largest of its residual structure, its χ², and
// its deviation from the references and thermometers, which are also data.
double excess_of(const ModuleFitter& fitter, const ModuleHypothesis& h, const ModuleTrial& trial,
                 const std::vector<ModuleRun>& runs, const Thresholds& limits) {
  std::vector<inference::ChannelResiduals> channels;
  for (size_t run = 0; run < runs.size(); ++run) {
    const VectorXd r = fitter.residuals(h, ModuleFitter::numbers_of(trial, run), runs[run]);
    channels.push_back({{r.data(), r.data() + r.size()}});
  }
  const double samples = static_cast<double>(trial.fit.samples);
  return std::max({inference::whiteness(channels, limits.noise).excess_sigma,
                   (trial.fit.data_chi2 / samples - 1.0) / std::sqrt(2.0 / samples),
                   trial.prior_excess_sigma()});
}

// Expected χ² of healthy curves from the errors of one diode and its translation. The standard
// deviations of the points count these errors once per correlation length.
double chi2_of_healthy(const ModuleNominal& nominal, const std::vector<ModuleRun>& runs) {
  double chi2 = 0.0;
  for (const ModuleRun& run : runs) {
    chi2 += static_cast<double>(run.sweep.voltage_V.size()) *
            std::pow(point_rms_A(nominal, run.sweep) / run.sigma_A, 2);
  }
  return chi2;
}

// The hypotheses of one kind, which differ in the number of cells, with their fits.
struct Family {
  std::vector<ModuleHypothesis> hypotheses;
  std::vector<ModuleTrial> trials;
};

std::vector<Family> families_of(const std::vector<ModuleHypothesis>& hypotheses) {
  std::vector<Family> families;
  for (const ModuleHypothesis& h : hypotheses) {
    const bool is_next =
        !families.empty() && h.count > 0 && families.back().hypotheses.back().kind == h.kind;
    if (!is_next) families.emplace_back();
    families.back().hypotheses.push_back(h);
  }
  return families;
}

// Fits hypotheses with rising numbers of cells until two in succession are hopeless compared with
// the best. The first three use all starts; the others start from the solution for the number
// before.
void fit_family(const ModuleFitter& fitter, const std::vector<ModuleRun>& runs, Family& family) {
  double best = -INFINITY;
  int behind = 0;
  constexpr size_t from_all_starts = 3;
  for (const ModuleHypothesis& h : family.hypotheses) {
    const bool continues = family.trials.size() >= from_all_starts;
    ModuleTrial trial = fitter.fit(h, runs, continues ? &family.trials.back().shared : nullptr);
    family.trials.push_back(std::move(trial));
    const double evidence = family.trials.back().log_evidence;
    best = std::max(best, evidence);
    behind = evidence < best - hopeless_log_evidence ? behind + 1 : 0;
    if (behind == 2) break;
  }
}

const ModuleTrial& best_of(const Family& family) {
  return *std::ranges::max_element(family.trials, {}, &ModuleTrial::log_evidence);
}

// If the log evidence of shaded cells is above `min_log_evidence`, adds cracked cells with a
// similar curve.
void add_crack_like_shade(const ModuleFitter& fitter, const ModuleDesign& design,
                          const ModuleNominal& nominal, const std::vector<ModuleRun>& runs,
                          double min_log_evidence, std::vector<Family>& families) {
  const auto of = [&](const std::string& kind) {
    return std::ranges::find_if(families,
                                [&](const Family& f) { return f.hypotheses.front().kind == kind; });
  };
  const auto shaded = of("cell_shaded"), cracked = of("cell_cracked");
  if (shaded == families.end() || cracked == families.end()) return;
  const ModuleTrial& trial = best_of(*shaded);
  if (!(trial.log_evidence > min_log_evidence)) return;
  const ModuleHypothesis& h =
      shaded->hypotheses[static_cast<size_t>(&trial - shaded->trials.data())];
  const size_t own = h.parameters.size();
  const double* first = trial.shared.data() + trial.shared.size() - own;
  Family like{{cracked_hypothesis(design, nominal, h, {first, own}, cracked->hypotheses.front())},
              {}};
  like.trials.push_back(fitter.fit(like.hypotheses.front(), runs));
  families.push_back(std::move(like));
}

// Fits all hypotheses except the first, which is already fitted, to the training curves. The best
// of each kind, and those that are not hopeless compared with the best of all, are then fitted to
// all data.
void fit_effects(const ModuleFitter& fitter, const ModuleDesign& design,
                 const ModuleNominal& nominal, const std::vector<ModuleHypothesis>& hypotheses,
                 const std::vector<ModuleRun>& train, const std::vector<ModuleRun>& everything,
                 int threads, ModuleAnswer& answer) {
  std::vector<Family> families = families_of({hypotheses.begin() + 1, hypotheses.end()});
  parallel_for(families.size(), threads, [&](size_t i) { fit_family(fitter, train, families[i]); });
  double best = -INFINITY;
  for (const Family& family : families) best = std::max(best, best_of(family).log_evidence);
  add_crack_like_shade(fitter, design, nominal, train, best - hopeless_log_evidence, families);
  for (Family& family : families) {
    const double of_kind = best_of(family).log_evidence;
    for (size_t i = 0; i < family.trials.size(); ++i) {
      const double own = family.trials[i].log_evidence;
      if (own < of_kind && own < best - hopeless_log_evidence) continue;
      answer.hypotheses.push_back(std::move(family.hypotheses[i]));
      answer.trials.push_back(std::move(family.trials[i]));
    }
  }
  answer.joint.resize(answer.trials.size());
  parallel_for(answer.trials.size() - 1, threads, [&](size_t i) {
    answer.joint[i + 1] =
        fitter.fit(answer.hypotheses[i + 1], everything, &answer.trials[i + 1].shared);
  });
}

// The most likely hypothesis of a kind by its fit to all data; 0 if it was not fitted.
size_t best_of_kind(const ModuleAnswer& answer, const std::string& kind) {
  size_t best = 0;
  for (size_t i = 1; i < answer.hypotheses.size(); ++i) {
    if (answer.hypotheses[i].kind != kind || !answer.trials[i].objection.empty()) continue;
    const bool is_better =
        best == 0 || answer.joint[i].log_evidence > answer.joint[best].log_evidence;
    if (is_better) best = i;
  }
  return best;
}

// Fitted parameters of the hypothesis, without those of the nominal module.
std::vector<double> own_of(const ModuleHypothesis& h, const ModuleTrial& trial) {
  const auto own = static_cast<Index>(h.parameters.size());
  const VectorXd x = trial.shared.tail(own);
  return {x.begin(), x.end()};
}

// Combines two effects. The starts are the fit of the first effect with every start of the second.
// If the second effect has no starts, every start of the first is used too: the fit of the first
// alone may have imitated both effects.
ModuleHypothesis pair_of(const ModuleAnswer& answer, size_t a, size_t b) {
  const ModuleHypothesis &of_a = answer.hypotheses[a], &of_b = answer.hypotheses[b];
  ModuleHypothesis h = both(of_a, a, of_b, b);
  const auto add_start = [&](std::vector<double> start, const std::vector<double>& of_second) {
    start.resize(h.parameters.size());
    for (size_t k = 0; k < of_second.size(); ++k) start[h.members[1].at[k]] = of_second[k];
    h.starts.push_back(std::move(start));
  };
  const std::vector<double> alone = own_of(of_a, answer.joint[a]);
  for (const std::vector<double>& start : of_b.starts) add_start(alone, start);
  if (!of_b.starts.empty()) return h;
  add_start(alone, own_of(of_b, answer.joint[b]));
  // A parameter at its lower bound starts this many prior standard deviations above it.
  constexpr double inside = 0.3;
  std::vector<double> plain;
  for (const inference::Parameter& p : of_b.parameters) {
    plain.push_back(p.value + (p.lowest == p.value ? inside * p.sigma : 0.0));
  }
  add_start(alone, plain);
  for (const std::vector<double>& start : of_a.starts) add_start(start, plain);
  return h;
}

// Fits of pairs of effects.
class Pairs {
 public:
  Pairs(const ModuleFitter& fitter, const std::vector<ModuleHypothesis>& all,
        const std::vector<ModuleRun>& train, const std::vector<ModuleRun>& everything, int threads,
        ModuleAnswer& answer)
      : fitter_(fitter),
        all_(all),
        train_(train),
        everything_(everything),
        threads_(threads),
        answer_(answer) {}

  // Fits pairs: a fault of some cells with another fault of some cells or with a fault of all
  // cells.
  void fit() {
    constexpr std::pair<const char*, const char*> kinds[] = {
        {"cell_shaded", "series_resistance"},      {"cell_shaded", "shunt"},
        {"cell_cracked", "series_resistance"},     {"cell_cracked", "shunt"},
        {"substring_shaded", "series_resistance"}, {"substring_shaded", "shunt"},
        {"bypass_shorted", "series_resistance"},   {"bypass_shorted", "shunt"},
        {"cell_shaded", "bypass_shorted"},         {"cell_shaded", "cell_shaded"},
        {"cell_shaded", "substring_shaded"}};
    const size_t first = answer_.hypotheses.size();
    std::vector<ModuleHypothesis> pairs;
    for (const auto& [one, other] : kinds) {
      const size_t a = best_of_kind(answer_, one), b = best_of_kind(answer_, other);
      if (a > 0 && b > 0) pairs.push_back(pair_of(answer_, a, b));
    }
    add(std::move(pairs), nullptr);
    if (first == answer_.hypotheses.size()) return;
    // Tries other numbers of cells as long as the evidence rises. In the presence of another fault,
    // the number of cells from the fit of a single fault is unreliable.
    constexpr int most_steps = 4;
    size_t best = best_from(first);
    for (int step = 0; step < most_steps; ++step) {
      std::vector<ModuleHypothesis> others = neighbours(best, first);
      const ModuleTrial near = answer_.joint[best];
      add(std::move(others), &near);
      const size_t next = best_from(first);
      if (next == best) break;
      best = next;
    }
  }

 private:
  // Fits hypotheses to the training curves and then to all curves. The fits start from the solution
  // `near` or, if that is null, from the starts of the hypotheses.
  void add(std::vector<ModuleHypothesis> more, const ModuleTrial* near) {
    std::vector<ModuleTrial> trials(more.size()), joint(more.size());
    parallel_for(more.size(), threads_, [&](size_t i) {
      trials[i] = fitter_.fit(more[i], train_, near != nullptr ? &near->shared : nullptr);
      joint[i] = fitter_.fit(more[i], everything_, &trials[i].shared);
    });
    const auto append = [](auto& to, auto& some) {
      std::ranges::move(some, std::back_inserter(to));
    };
    append(answer_.hypotheses, more);
    append(answer_.trials, trials);
    append(answer_.joint, joint);
  }

  // Index of the best pair at or after index `first`, which must be a pair.
  size_t best_from(size_t first) const {
    size_t best = first;
    for (size_t i = first; i < answer_.joint.size(); ++i) {
      if (answer_.hypotheses[i].members.empty()) continue;
      if (answer_.joint[i].log_evidence > answer_.joint[best].log_evidence) best = i;
    }
    return best;
  }

  // Index of the effect with `count` cells, which is fitted if it has not been.
  size_t with_count(size_t effect, int count) {
    const std::string kind = answer_.hypotheses[effect].kind;
    const auto is_it = [&](const ModuleHypothesis& h) {
      return h.kind == kind && h.count == count;
    };
    const auto& fitted = answer_.hypotheses;
    const auto found = std::ranges::find_if(fitted, is_it);
    if (found != fitted.end()) return static_cast<size_t>(found - fitted.begin());
    const ModuleTrial near = answer_.joint[effect];
    add({*std::ranges::find_if(all_, is_it)}, &near);
    return fitted.size() - 1;
  }

  // Pairs that have not been fitted, in which one effect has the next smaller or larger number of
  // cells.
  std::vector<ModuleHypothesis> neighbours(size_t pair, size_t first) {
    std::vector<ModuleHypothesis> result;
    for (size_t which = 0; which < 2; ++which) {
      const size_t effect = answer_.hypotheses[pair].members[which].hypothesis;
      const int own = answer_.hypotheses[effect].count;
      int below = 0, above = 0;
      for (const ModuleHypothesis& h : all_) {
        if (own == 0 || h.kind != answer_.hypotheses[effect].kind) continue;
        if (h.count < own) below = std::max(below, h.count);
        if (h.count > own && (above == 0 || h.count < above)) above = h.count;
      }
      for (const int count : {below, above}) {
        if (count == 0) continue;
        size_t members[2] = {answer_.hypotheses[pair].members[0].hypothesis,
                             answer_.hypotheses[pair].members[1].hypothesis};
        members[which] = with_count(effect, count);
        const auto is_same = [&](const ModuleHypothesis& h) {
          return h.members.size() == 2 && h.members[0].hypothesis == members[0] &&
                 h.members[1].hypothesis == members[1];
        };
        const auto from = answer_.hypotheses.begin() + static_cast<Index>(first);
        if (std::any_of(from, answer_.hypotheses.end(), is_same)) continue;
        result.push_back(pair_of(answer_, members[0], members[1]));
      }
    }
    return result;
  }

  const ModuleFitter& fitter_;
  const std::vector<ModuleHypothesis>& all_;
  const std::vector<ModuleRun>&train_, &everything_;
  int threads_;
  ModuleAnswer& answer_;
};

// Refits hypothesis `i` from the solution `near`, to the training curves and to all curves, and
// keeps the fits of lower χ². Returns whether it found a lower χ² of all curves.
bool refit(const ModuleFitter& fitter, const std::vector<ModuleRun>& train,
           const std::vector<ModuleRun>& everything, size_t i, const VectorXd& near,
           ModuleAnswer& answer) {
  const auto improves = [&](const std::vector<ModuleRun>& runs, ModuleTrial& old) {
    ModuleTrial fit = fitter.fit(answer.hypotheses[i], runs, &near);
    constexpr double min_gain = 1e-3;  // smallest fall of χ² that counts
    if (!(fit.fit.chi2 < old.fit.chi2 - min_gain)) return false;
    old = std::move(fit);
    return true;
  };
  improves(train, answer.trials[i]);
  return improves(everything, answer.joint[i]);
}

// Refits the models that a better one contains (the nominal one, and each effect of a pair) from
// its solution. Without its effects the solution may be a lower minimum of theirs, and their excess
// of χ² is the significance of the effects. The most likely explanations come first, until one
// remains more likely than the nominal model.
void refit_parts(const ModuleFitter& fitter, const std::vector<ModuleRun>& train,
                 const std::vector<ModuleRun>& everything, int threads, const Thresholds& limits,
                 ModuleAnswer& answer) {
  const auto module = [](const ModuleTrial& trial) -> VectorXd {
    return trial.shared.head(ModuleNominal::numbers);
  };
  bool is_lower = false;
  for (const size_t i : sorted_indices(answer.joint.size(), [&](size_t a, size_t b) {
         return answer.joint[a].log_evidence > answer.joint[b].log_evidence;
       })) {
    const ModuleTrial whole = answer.joint[i];
    const auto odds = [&] { return whole.log_evidence - answer.joint.front().log_evidence; };
    if (i == 0 || odds() < limits.decision.min_log_odds) break;
    for (const auto& member : answer.hypotheses[i].members) {
      VectorXd near(ModuleNominal::numbers + static_cast<Index>(member.at.size()));
      near.head(ModuleNominal::numbers) = module(whole);
      for (size_t k = 0; k < member.at.size(); ++k) {
        near[ModuleNominal::numbers + static_cast<Index>(k)] =
            whole.shared[ModuleNominal::numbers + static_cast<Index>(member.at[k])];
      }
      refit(fitter, train, everything, member.hypothesis, near, answer);
    }
    is_lower = refit(fitter, train, everything, 0, module(whole), answer) || is_lower;
    if (odds() > limits.decision.min_log_odds) break;
  }
  if (!is_lower) return;
  parallel_for(answer.joint.size() - 1, threads, [&](size_t i) {
    VectorXd near = answer.joint[i + 1].shared;
    near.head(ModuleNominal::numbers) = module(answer.joint.front());
    refit(fitter, train, everything, i + 1, near, answer);
  });
}

// Sets the prediction of the held-out data by each trial and the significance of its effects, and
// decides.
void decide_on(const ModuleFitter& fitter, const ModuleData& data, const Thresholds& limits,
               ModuleAnswer& answer) {
  const size_t count = answer.hypotheses.size();
  std::vector<inference::CandidateTraits> traits(count);
  const auto candidates_of = [&](size_t i) -> std::vector<size_t> {
    if (i == 0) return {};
    std::vector<size_t> candidates;
    for (const auto& member : answer.hypotheses[i].members) candidates.push_back(member.hypothesis);
    return candidates.empty() ? std::vector{i} : candidates;
  };
  // Index of the trial without the effect `which` of trial `i`.
  const auto without = [&](size_t i, size_t which) -> size_t {
    const auto& members = answer.hypotheses[i].members;
    return members.empty() ? 0 : members[1 - which].hypothesis;
  };
  for (size_t i = 0; i < count; ++i) {
    const ModuleHypothesis& h = answer.hypotheses[i];
    traits[i].name = h.kind.empty() ? h.label : h.kind;
    // If the largest tested number of cells is the best one, the effect is distributed over the
    // module in a way that this kind only imitates.
    traits[i].is_empirical = h.is_empirical || (h.count > 1 && h.count == h.largest_count);
    traits[i].parameters = h.parameters.size();
    answer.trials[i].candidates = candidates_of(i);
  }
  for (size_t i = 0; i < count; ++i) {
    ModuleTrial &train = answer.trials[i], &joint = answer.joint[i];
    const double held = static_cast<double>(joint.fit.samples - train.fit.samples);
    inference::Predictive p;
    p.chi2_per_sample = (joint.fit.chi2 - train.fit.chi2) / held;
    p.log_score = joint.log_evidence - train.log_evidence;
    p.expected_chi2_per_sample = inference::predict_held_out(train.fit, joint.fit).chi2_per_sample;
    p.sigma = (p.chi2_per_sample - 1.0) /
              std::sqrt(2.0 / held + 2.0 / static_cast<double>(train.fit.samples));
    train.significance.clear();
    train.joint_significance.clear();
    for (size_t which = 0; which < train.candidates.size(); ++which) {
      const size_t rest = without(i, which);
      train.significance.push_back(
          std::sqrt(std::max(0.0, answer.trials[rest].fit.chi2 - train.fit.chi2)));
      train.joint_significance.push_back(
          std::sqrt(std::max(0.0, answer.joint[rest].fit.chi2 - joint.fit.chi2)));
    }
    train.holdout_chi2_per_sample = p.chi2_per_sample;
    train.predictive = p;
  }
  std::vector<inference::Explanation> trials(answer.trials.begin(), answer.trials.end());
  for (size_t i = 0; i < count; ++i) trials[i].log_evidence = answer.joint[i].log_evidence;
  // References and thermometers are data that a fit to the curves predicts. If a fit without the
  // effect contradicts them, the fall of their χ² may count in place of the gain of the segments.
  const auto gain = [&](size_t trial, size_t which) -> std::optional<double> {
    const size_t rest = without(trial, which);
    const auto chi2 = [&](size_t of) {
      return chi2_of_segments(fitter, answer.hypotheses[of], answer.joint[of], data.whole, limits);
    };
    const double of_segments = inference::gain_sigma(chi2(rest), chi2(trial));
    const ModuleTrial &worse = answer.joint[rest], &better = answer.joint[trial];
    const bool contradicts = worse.prior_excess_sigma() > limits.decision.max_excess_sigma;
    if (!contradicts || of_segments < -inference::GateLimits{}.min_gain_sigma) return of_segments;
    return std::max(of_segments,
                    std::sqrt(std::max(0.0, worse.prior_chi2() - better.prior_chi2())));
  };
  const auto excess = [&](size_t trial) {
    return excess_of(fitter, answer.hypotheses[trial], answer.trials[trial], data.train, limits);
  };
  answer.decision = inference::decide(trials, traits, {excess, gain}, limits.decision);
}

}  // namespace

std::pair<ModuleRun, ModuleRun> split_curve(const ModuleRun& run) {
  return split_curve(run, std::max<size_t>(1, run.sweep.voltage_V.size() / 40),
                     [](size_t segment) { return segment % 4 == 2; });
}

ModuleAnswer explain_module(const ModuleDesign& design, const ModuleNominal& nominal,
                            const std::vector<ModuleHypothesis>& hypotheses, const ModuleData& data,
                            int threads, const Thresholds& limits) {
  ModuleAnswer answer;
  const ModuleFitter fitter(design, nominal, limits);
  std::vector<ModuleRun> everything = data.train;
  everything.insert(everything.end(), data.held.begin(), data.held.end());
  answer.hypotheses = {hypotheses.front()};
  answer.trials = {fitter.fit(hypotheses.front(), data.train)};
  answer.joint = {fitter.fit(hypotheses.front(), everything, &answer.trials.front().shared)};
  decide_on(fitter, data, limits, answer);
  // No effect is detectable if χ² is at most one per point and at most four times that of healthy
  // curves, which differ from one diode and its translation.
  constexpr double of_healthy = 4.0;
  const double most_chi2 = of_healthy * chi2_of_healthy(nominal, everything);
  const auto leaves_more = [&](const ModuleTrial& trial) {
    const inference::Fit& fit = trial.fit;
    return !(fit.data_chi2 <= std::min(static_cast<double>(fit.samples), most_chi2)) ||
           trial.prior_excess_sigma() > limits.decision.max_excess_sigma;
  };
  const bool is_odd = answer.decision.verdict != inference::Verdict::consistent;
  if (!is_odd && !leaves_more(answer.joint.front())) return answer;
  fit_effects(fitter, design, nominal, hypotheses, data.train, everything, threads, answer);
  size_t best = 0;  // best physical hypothesis
  for (size_t i = 1; i < answer.joint.size(); ++i) {
    if (answer.hypotheses[i].is_empirical) continue;
    if (answer.joint[i].log_evidence > answer.joint[best].log_evidence) best = i;
  }
  if (leaves_more(answer.joint[best])) {
    Pairs(fitter, hypotheses, data.train, everything, threads, answer).fit();
  }
  refit_parts(fitter, data.train, everything, threads, limits, answer);
  decide_on(fitter, data, limits, answer);
  return answer;
}

}  // namespace photorque
