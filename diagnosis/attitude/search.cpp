#include "diagnosis/attitude/search.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "diagnosis/attitude/averaging.h"
#include "diagnosis/attitude/leaders.h"
#include "diagnosis/attitude/scan.h"
#include "diagnosis/attitude/screen.h"
#include "diagnosis/attitude/whiteness.h"

namespace photorque {
namespace {

struct Task {
  size_t candidate;
  Disturbance start;
};

// Whether the slopes of a fit say little, because the trajectory is elsewhere.
bool has_diverged(const Trial& trial, const Candidates& all) {
  return trial.fit.chi2_per_sample() > all.limits.diverged_chi2_per_sample;
}

// The runs, or what each was cut into.
struct Runs {
  std::vector<Observation> all;
  size_t pieces = 1;  // of each recording

  // In fewer blocks: enough for changes of the fit that are slow, and several times faster.
  std::vector<Observation> averaged(const Fit& about, const Thresholds& limits) const {
    return averaged_about(about, all, limits.fitting.slow_blocks / pieces);
  }
};

// Every run cut into as many pieces, each of which will have a start of its own.
Runs cut(const std::vector<Observation>& runs, size_t pieces, const Thresholds& limits) {
  const auto fewest_attitudes = static_cast<std::ptrdiff_t>(limits.search.min_readings_of_piece);
  Runs result{{}, pieces};
  for (const Observation& seen : runs) {
    for (size_t i = 0; i < pieces; ++i) {
      const size_t first = i * seen.blocks() / pieces, last = (i + 1) * seen.blocks() / pieces;
      if (first == last) continue;
      Observation piece = seen.part(first, last);
      const auto attitudes = std::count_if(piece.attitude_rows.begin(), piece.attitude_rows.end(),
                                           [](double rows) { return rows > 0.0; });
      if (attitudes >= fewest_attitudes) result.all.push_back(std::move(piece));
    }
  }
  return result;
}

struct Promising {
  std::vector<size_t> candidates;
  double min_gain;  // that a scan's start must predict, to be worth a fit beside these
};

// Where the trajectory is near the readings, the score test predicts what each candidate would
// gain: those that would gain hardly anything against the best need no fit of their own.
Promising promising(const Trial& parent, const Candidates& all,
                    const std::vector<size_t>& candidates,
                    const std::vector<Observation>& slow_runs) {
  const Thresholds::Scoring& limits = all.limits.scoring;
  if (has_diverged(parent, all)) return {candidates, 0.0};
  std::vector<ScoreGroup> groups;
  for (const size_t c : candidates) {
    groups.push_back(
        {all[c].is_linear() ? std::vector<Disturbance>{all[c].start} : std::vector<Disturbance>{}});
  }
  const std::vector<Score> scores = score(parent.fit, slow_runs, groups);
  double best = 0.0;
  for (const Score& s : scores) best = std::max(best, s.gain);
  Promising result{{}, limits.min_fraction * best};
  for (size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = all[candidates[i]];
    const double parameters = static_cast<double>(c.start.parameters.size());
    const bool worth_it = scores[i].gain > std::max(limits.min_gain + parameters, result.min_gain);
    if (!c.is_linear() || worth_it) result.candidates.push_back(candidates[i]);
  }
  return result;
}

// Averages and pieces flatter some: what was not fitted to the full readings stands below the first
// `fitted` of these trials, which were, as it stood before.
void keep_below(std::vector<Trial>& trials, size_t fitted) {
  double lowest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < fitted; ++i) lowest = std::min(lowest, trials[i].log_evidence);
  for (size_t i = fitted; i < trials.size(); ++i) {
    trials[i].log_evidence = std::min(trials[i].log_evidence, lowest);
  }
}

// The fits of all tasks on `runs`; of several starts of a candidate the best.
std::vector<Trial> extend_by_tasks(const Trial& parent, const Candidates& all,
                                   const std::vector<Task>& tasks,
                                   const std::vector<Observation>& runs, int threads) {
  std::vector<Trial> trials(tasks.size());
  parallel_for(tasks.size(), threads, [&](size_t i) {
    FitSettings settings;
    settings.max_iterations = all.limits.fitting.trial_iterations;
    trials[i] = extend(parent, all, tasks[i].candidate, tasks[i].start, runs, settings);
  });
  std::vector<Trial> best;
  for (Trial& trial : trials) {
    if (!best.empty() && best.back().candidates == trial.candidates) {
      if (trial.log_evidence > best.back().log_evidence) best.back() = std::move(trial);
    } else {
      best.push_back(std::move(trial));
    }
  }
  return best;
}

// Every candidate added to `parent`, whose slopes can be trusted. Slow laws are fitted to averages
// first; those that come near the best, and all fast ones, to the full runs.
std::vector<Trial> extend_near(const Trial& parent, const Candidates& all,
                               const std::vector<size_t>& candidates, const Runs& run_set,
                               int threads) {
  const std::vector<Observation>& runs = run_set.all;
  const std::vector<Observation> slow_runs = run_set.averaged(parent.fit, all.limits);
  std::vector<double> lines_Hz;
  Promising hopeful;
  parallel_for(2, threads, [&](size_t i) {
    if (i == 0) lines_Hz = line_frequencies_Hz(parent.fit, runs, all.limits.scoring);
    if (i == 1) hopeful = promising(parent, all, candidates, slow_runs);
  });
  const std::vector<size_t>& worth_it = hopeful.candidates;
  std::vector<std::vector<Start>> starts(worth_it.size());
  parallel_for(worth_it.size(), threads, [&](size_t i) {
    starts[i] = starts_of(all[worth_it[i]], parent, runs, slow_runs, lines_Hz, all.limits.scoring);
  });
  std::vector<Task> slow, fast;
  for (size_t i = 0; i < worth_it.size(); ++i) {
    const bool is_fast = all[worth_it[i]].effect.how.fast;
    for (const Start& start : starts[i]) {
      if (start.gain < hopeful.min_gain) continue;
      (is_fast ? fast : slow).push_back({worth_it[i], start.disturbance});
    }
  }
  std::vector<Trial> found = extend_by_tasks(parent, all, fast, runs, threads);
  std::vector<Trial> rough = extend_by_tasks(parent, all, slow, slow_runs, threads);
  // Their evidence counts as what they gain over the parent on the same averages.
  const double rough_parent = refit(parent, all, slow_runs, parent.fit.best.runs).log_evidence;
  for (Trial& t : rough) t.log_evidence += parent.log_evidence - rough_parent;
  std::stable_sort(rough.begin(), rough.end(),
                   [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
  const size_t refits = std::min(all.limits.search.max_refits_of_averages, rough.size());
  parallel_for(refits, threads,
               [&](size_t i) { rough[i] = refit(rough[i], all, runs, rough[i].fit.best.runs); });
  keep_below(rough, refits);
  for (Trial& t : rough) found.push_back(std::move(t));
  return found;
}

// Every candidate added to a parent that has diverged. A trajectory far from the readings says
// little about why, so the runs are cut into pieces, each with a start of its own, in which it
// stays near them; what explains the pieces best is then fitted to the whole (multiple shooting).
std::vector<Trial> extend_by_pieces(const Trial& parent, const Candidates& all,
                                    const std::vector<size_t>& candidates,
                                    const std::vector<Observation>& runs, int threads) {
  const Thresholds::Search& limits = all.limits.search;
  Runs pieces{runs};
  Trial near = parent;
  for (const size_t count : limits.pieces) {
    Runs shorter = cut(runs, count, all.limits);
    // Too few readings to be cut.
    if (shorter.all.empty()) break;
    pieces = std::move(shorter);
    near = refit(parent, all, pieces.all, seen_starts(parent.fit.best, pieces.all));
    if (near.fit.chi2_per_sample() < all.limits.diverged_chi2_per_sample) break;
  }
  std::vector<Trial> found = extend_near(near, all, candidates, pieces, threads);
  std::stable_sort(found.begin(), found.end(),
                   [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
  FitSettings growing;
  growing.windows = all.limits.fitting.diverged_windows;
  size_t refits = 0;
  const size_t most = std::min(limits.max_refits_of_pieces, found.size());
  while (refits < most && is_near(found[refits], found.front(), all.limits)) {
    ++refits;
  }
  parallel_for(found.size(), threads, [&](size_t i) {
    Trial& t = found[i];
    const std::vector<RunStart> starts = seen_starts(t.fit.best, runs);
    if (i < refits) {
      t = refit(t, all, runs, starts, growing);
    } else {
      t.log_evidence += parent.log_evidence - near.log_evidence;
      t.fit.best.runs = starts;
    }
  });
  keep_below(found, refits);
  return found;
}

std::vector<Trial> extend_by_each(const Trial& parent, const Candidates& all,
                                  const std::vector<size_t>& candidates,
                                  const std::vector<Observation>& runs, int threads) {
  if (has_diverged(parent, all)) {
    return extend_by_pieces(parent, all, candidates, runs, threads);
  }
  return extend_near(parent, all, candidates, {runs}, threads);
}

// One kind acts once, in whatever parametrisation.
bool contains(const Trial& trial, const Candidates& all, size_t candidate) {
  return std::any_of(trial.candidates.begin(), trial.candidates.end(),
                     [&](size_t c) { return all[c].label == all[candidate].label; });
}

// Of trials of the same effects, found in different order, the best.
std::vector<Trial> without_twins(std::vector<Trial> trials) {
  std::vector<Trial> kept;
  std::vector<std::vector<size_t>> sets;
  for (Trial& trial : trials) {
    std::vector<size_t> set = trial.candidates;
    std::sort(set.begin(), set.end());
    const auto twin = std::find(sets.begin(), sets.end(), set);
    if (twin == sets.end()) {
      sets.push_back(std::move(set));
      kept.push_back(std::move(trial));
    } else if (Trial& other = kept[static_cast<size_t>(twin - sets.begin())];
               trial.log_evidence > other.log_evidence) {
      other = std::move(trial);
    }
  }
  return kept;
}

bool is_physics(const Trial& trial, const Candidates& all) {
  return std::none_of(trial.candidates.begin(), trial.candidates.end(),
                      [&](size_t c) { return all[c].empirical(); });
}

// A pair is found by way of its stronger half, which may have been another kind that takes its
// place: the other half alone, where it has not been a parent, to be extended in turn.
std::vector<Trial> other_halves(const Trial& pair, const std::vector<Trial>& parents,
                                const std::vector<Trial>& singles, const Candidates& all,
                                const std::vector<Observation>& runs) {
  std::vector<Trial> halves;
  for (const size_t candidate : pair.candidates) {
    const std::vector<size_t> half = {candidate};
    const auto is_half = [&](const Trial& t) { return t.candidates == half; };
    if (std::any_of(parents.begin(), parents.end(), is_half)) continue;
    const auto single = std::find_if(singles.begin(), singles.end(), is_half);
    if (single != singles.end()) {
      halves.push_back(refit(*single, all, runs, single->fit.best.runs));
    }
  }
  return halves;
}

// Two effects that hide each other: alone neither may be what explains most. Near the readings the
// score test predicts what every pair would gain; the best are fitted.
std::vector<Trial> best_pairs(const Trial& nominal, const Candidates& all,
                              const std::vector<Observation>& runs, const std::vector<Trial>& known,
                              int threads) {
  const Thresholds::Scoring& limits = all.limits.scoring;
  const size_t max_pairs = all.limits.search.max_pairs;
  if (has_diverged(nominal, all)) return {};
  const std::vector<Observation> slow_runs = Runs{runs}.averaged(nominal.fit, all.limits);
  std::vector<size_t> linear;
  std::vector<ScoreGroup> groups;
  for (size_t c = 0; c < all.size(); ++c) {
    if (all[c].empirical() || !all[c].is_linear()) continue;
    linear.push_back(c);
    groups.push_back({{all[c].start}});
  }
  const Eigen::MatrixXd gains = score_pairs(nominal.fit, slow_runs, groups);
  struct Pair {
    size_t first, second;
    double gain;
  };
  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < gains.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < gains.cols(); ++j) {
      // The stronger first.
      const auto [a, b] = gains(i, i) > gains(j, j) ? std::pair(i, j) : std::pair(j, i);
      const Pair pair{linear[static_cast<size_t>(a)], linear[static_cast<size_t>(b)], gains(i, j)};
      if (all[pair.first].label == all[pair.second].label) continue;
      if (gains(i, j) < gains(a, a) + limits.min_pair_gain) continue;
      const bool tried = std::any_of(known.begin(), known.end(), [&](const Trial& t) {
        return t.candidates == std::vector<size_t>{pair.first, pair.second} ||
               t.candidates == std::vector<size_t>{pair.second, pair.first};
      });
      if (!tried) pairs.push_back(pair);
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) {
    const auto worth = [&](const Pair& p) {
      const size_t parameters =
          all[p.first].start.parameters.size() + all[p.second].start.parameters.size();
      return p.gain - limits.cost_per_parameter * static_cast<double>(parameters);
    };
    return worth(a) > worth(b);
  });
  if (pairs.size() > max_pairs) pairs.resize(max_pairs);
  std::vector<Trial> found(pairs.size());
  parallel_for(pairs.size(), threads, [&](size_t i) {
    const Pair& p = pairs[i];
    const Trial one = extend(nominal, all, p.first, all[p.first].start, slow_runs);
    const Trial two = extend(one, all, p.second, all[p.second].start, slow_runs);
    found[i] = refit(two, all, runs, two.fit.best.runs);
  });
  return found;
}

}  // namespace

std::vector<Trial> search(const Fit& nominal, const Candidates& all,
                          const std::vector<Observation>& runs, const SearchOptions& options) {
  const Thresholds::Search& limits = all.limits.search;
  std::vector<Trial> trials = {nominal_trial(nominal, all)};
  std::vector<Trial> parents = trials;
  for (int effects = 1; effects <= options.max_effects; ++effects) {
    std::vector<Trial> found;
    const auto extend_all = [&](const Trial& parent, bool with_empirical) {
      std::vector<size_t> others;
      for (size_t c = 0; c < all.size(); ++c) {
        if (all[c].empirical() && !with_empirical) continue;
        if (!contains(parent, all, c)) others.push_back(c);
      }
      for (Trial& t : extend_by_each(parent, all, others, runs, options.threads)) {
        found.push_back(std::move(t));
      }
    };
    // Empirical laws compete alone and beside the best physics.
    for (const Trial& parent : parents) {
      extend_all(parent, effects <= 2 && &parent == &parents.front());
    }
    if (effects == 2 && !found.empty()) {
      const Trial best = found[by_evidence(found).front()];
      const bool gained =
          best.log_evidence > parents.front().log_evidence + limits.min_log_evidence_gain;
      if (gained && is_physics(best, all)) {
        for (const Trial& half : other_halves(best, parents, trials, all, runs)) {
          extend_all(half, false);
        }
      }
      for (Trial& t : best_pairs(trials.front(), all, runs, found, options.threads)) {
        found.push_back(std::move(t));
      }
    }
    found = without_twins(std::move(found));
    settle_leaders(found, parents, trials, all, runs, options.threads);
    // The best physics goes on, and the next best while the best leaves structure behind; when
    // nothing gained, nothing more will.
    const size_t max_parents = effects == 1 ? limits.max_single_parents : limits.max_parents;
    std::vector<Trial> next;
    for (const size_t i : by_evidence(found)) {
      const bool gained =
          found[i].log_evidence > parents.front().log_evidence + limits.min_log_evidence_gain;
      if (!gained || next.size() == max_parents) break;
      if (!is_physics(found[i], all)) {
        continue;
      }
      if (!found[i].objection.empty()) continue;
      // Two effects that leave the trajectory elsewhere: no third will bring it back.
      if (effects >= 2 && has_diverged(found[i], all)) break;
      next.push_back(found[i]);
      if (excess_sigma(found[i].fit, runs, all.limits.noise) < limits.explained_sigma) break;
    }
    for (Trial& t : found) trials.push_back(std::move(t));
    if (next.empty()) break;
    parents = std::move(next);
  }
  return trials;
}

}  // namespace photorque
