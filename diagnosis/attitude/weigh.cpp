#include "diagnosis/attitude/weigh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "diagnosis/attitude/averaging.h"
#include "diagnosis/attitude/holdout.h"
#include "diagnosis/attitude/leaders.h"
#include "diagnosis/attitude/screen.h"

namespace photorque {
namespace {

// An explanation on the train runs, by its place among the trials, and on all runs.
struct Leader {
  size_t at;
  Trial joint;
};

// Trials within reach of the best by their evidence, and the nominal model.
std::vector<size_t> leaders_among(const std::vector<Trial>& trials,
                                  const Thresholds::HeldOut& limits) {
  const std::vector<size_t> order = by_evidence(trials);
  std::vector<size_t> leaders;
  for (const size_t i : order) {
    if (!trials[i].objection.empty() || leaders.size() == limits.max_leaders) continue;
    if (trials[i].log_evidence < trials[order.front()].log_evidence - limits.within) break;
    leaders.push_back(i);
  }
  if (std::find(leaders.begin(), leaders.end(), 0u) == leaders.end()) leaders.push_back(0);
  return leaders;
}

class Weighing {
 public:
  Weighing(std::vector<Trial>& trials, const Candidates& all, const HeldOut& data, int threads)
      : trials_(trials), all_(all), data_(data), threads_(threads), joint_(data.train) {
    joint_.insert(joint_.end(), data.held.begin(), data.held.end());
  }

  void run() {
    const std::vector<size_t> places = leaders_among(trials_, all_.limits.held_out);
    const double nominal = trials_.front().log_evidence;
    const double gain = trials_[places.front()].log_evidence - nominal;
    add_leaders(places);
    const size_t found = trials_.size();
    add_what_only_all_show(trials_.front().candidates);
    add_what_only_all_show(best().candidates);
    learn();
    for (const Leader& leader : leaders_) {
      Trial& trial = trials_[leader.at];
      trial.log_evidence = leader.joint.log_evidence;
      trial.joint_significance = leader.joint.significance;
      if (trial.objection.empty()) trial.objection = leader.joint.objection;
    }
    keep_below(found, nominal, gain);
  }

 private:
  void add_leaders(const std::vector<size_t>& places) {
    leaders_.resize(places.size());
    const int64_t samples = trials_.front().fit.samples;
    parallel_for(places.size(), threads_, [&](size_t k) {
      Trial& t = trials_[places[k]];
      // Some were fitted to averages or pieces only.
      if (t.fit.samples != samples) t = refit(t, all_, data_.train, t.fit.best.runs);
      leaders_[k] = {places[k], fit_together(t)};
    });
    learn();
  }

  Trial fit_together(Trial& t) const {
    const Fit held = propagate_model(t.fit, data_.held, all_.limits);
    if (std::isfinite(held.chi2)) t.holdout_chi2_per_sample = held.chi2_per_sample();
    std::vector<RunStart> starts = t.fit.best.runs;
    starts.insert(starts.end(), held.best.runs.begin(), held.best.runs.end());
    return refit(t, all_, joint_, starts, patient_fit(all_.limits));
  }

  void learn() {
    std::vector<Trial> joint;
    for (Leader& leader : leaders_) joint.push_back(std::move(leader.joint));
    learn_from_best(joint, all_, joint_, threads_);
    for (size_t k = 0; k < joint.size(); ++k) leaders_[k].joint = std::move(joint[k]);
  }

  const Trial& best() const {
    return std::max_element(leaders_.begin(), leaders_.end(),
                            [](const Leader& a, const Leader& b) {
                              return a.joint.log_evidence < b.joint.log_evidence;
                            })
        ->joint;
  }

  // Candidates that would gain beside `parent` (one of the leaders) on all runs, and were not tried
  // or not among the leaders.
  void add_what_only_all_show(const std::vector<size_t>& parent) {
    const auto is_parent = [&](const Leader& l) { return trials_[l.at].candidates == parent; };
    const auto at = std::find_if(leaders_.begin(), leaders_.end(), is_parent);
    const Trial joint = at->joint, train = trials_[at->at];
    if (!(joint.fit.chi2_per_sample() < all_.limits.diverged_chi2_per_sample)) return;
    std::vector<size_t> untried;
    std::vector<ScoreGroup> groups;
    for (size_t c = 0; c < all_.size(); ++c) {
      std::vector<size_t> together = parent;
      together.push_back(c);
      if (!all_[c].is_linear() || acts(parent, c) || leads(together)) continue;
      untried.push_back(c);
      groups.push_back({{all_[c].start}});
    }
    const std::vector<Score> scores = score(
        joint.fit, averaged_about(joint.fit, joint_, all_.limits.fitting.slow_blocks), groups);
    const std::vector<size_t> worth_it = best_of(untried, scores);
    std::vector<Trial> on_train(worth_it.size()), on_all(worth_it.size());
    parallel_for(worth_it.size(), threads_, [&](size_t k) {
      const size_t c = untried[worth_it[k]];
      on_train[k] = extend(train, all_, c, all_[c].start, data_.train);
      on_all[k] = extend(joint, all_, c, all_[c].start, joint_, patient_fit(all_.limits));
      const Fit held = propagate_model(on_train[k].fit, data_.held, all_.limits);
      if (std::isfinite(held.chi2)) on_train[k].holdout_chi2_per_sample = held.chi2_per_sample();
    });
    for (size_t k = 0; k < worth_it.size(); ++k) {
      leaders_.push_back({place_of(std::move(on_train[k])), std::move(on_all[k])});
    }
  }

  // Places of the few candidates with the largest predicted gains, of the catalogue and of
  // empirical laws.
  std::vector<size_t> best_of(const std::vector<size_t>& candidates,
                              const std::vector<Score>& scores) const {
    const Thresholds::HeldOut& limits = all_.limits.held_out;
    const auto beyond_chance = [&](size_t i) {
      return scores[i].gain - static_cast<double>(all_[candidates[i]].start.parameters.size());
    };
    std::vector<size_t> order;
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (beyond_chance(i) > all_.limits.scoring.min_joint_gain) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return beyond_chance(a) > beyond_chance(b); });
    std::vector<size_t> best;
    size_t effects = 0, laws = 0;
    for (const size_t i : order) {
      const bool law = all_[candidates[i]].empirical();
      if (law ? laws++ < limits.max_empirical : effects++ < limits.max_effects) best.push_back(i);
    }
    return best;
  }

  // One kind acts once, in whatever parametrisation.
  bool acts(const std::vector<size_t>& candidates, size_t c) const {
    return std::any_of(candidates.begin(), candidates.end(),
                       [&](size_t other) { return all_[other].label == all_[c].label; });
  }

  bool leads(std::vector<size_t> candidates) const {
    return std::any_of(leaders_.begin(), leaders_.end(), [&](const Leader& l) {
      return std::is_permutation(candidates.begin(), candidates.end(),
                                 trials_[l.at].candidates.begin(), trials_[l.at].candidates.end());
    });
  }

  // Where the trial stands among all: in the place of one of the same candidates, if there is any.
  size_t place_of(Trial trial) {
    for (size_t i = 0; i < trials_.size(); ++i) {
      if (std::is_permutation(trial.candidates.begin(), trial.candidates.end(),
                              trials_[i].candidates.begin(), trials_[i].candidates.end())) {
        trials_[i] = std::move(trial);
        return i;
      }
    }
    trials_.push_back(std::move(trial));
    return trials_.size() - 1;
  }

  // Of the first `found` trials those that are no leaders.
  void keep_below(size_t found, double nominal, double gain) {
    // Of the leaders, but for the nominal model. One may diverge on what it never saw.
    const double nominal_now = trials_.front().log_evidence;
    double lowest = std::numeric_limits<double>::infinity(), highest = nominal_now;
    std::vector<bool> is_leader(trials_.size(), false);
    for (const Leader& leader : leaders_) {
      is_leader[leader.at] = true;
      if (leader.at != 0) lowest = std::min(lowest, trials_[leader.at].log_evidence);
      highest = std::max(highest, trials_[leader.at].log_evidence);
    }
    const double ratio = gain > 0.0 ? (highest - nominal_now) / gain : 1.0;
    for (size_t i = 0; i < found; ++i) {
      if (is_leader[i]) continue;
      double& evidence = trials_[i].log_evidence;
      evidence = std::min(lowest, nominal_now + ratio * (evidence - nominal));
    }
  }

  std::vector<Trial>& trials_;
  const Candidates& all_;
  const HeldOut& data_;
  int threads_;
  std::vector<Observation> joint_;  // the train runs, then those held out
  std::vector<Leader> leaders_;
};

}  // namespace

void weigh_with_holdout(std::vector<Trial>& trials, const Candidates& all, const HeldOut& data,
                        int threads) {
  Weighing(trials, all, data, threads).run();
}

}  // namespace photorque
