#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>

#include "core/parallel.h"
#include "diagnosis/attitude/answer.h"
#include "inference/trials.h"

namespace photorque {
namespace {

// Violation of physical bounds by the trial's `which`-th law [standard errors]; 0 within them.
double beyond_physics(const Trial& trial, const Candidates& all, size_t which) {
  const Candidate& c = all[trial.candidates[which]];
  const Eigen::MatrixXd covariance = trial.fit.shared_posterior();
  double farthest = 0.0;
  for (const auto& [disturbance, p, at, value] : fitted_numbers(trial, which)) {
    const double beyond = std::max(c.lowest[p] - value, value - c.highest[p]);
    if (beyond > 0.0) farthest = std::max(farthest, beyond / std::sqrt(covariance(at, at)));
  }
  return farthest;
}

// The next law to remove: the one with the largest violation of its bounds, otherwise the least
// significant one, below `needed` standard errors. Nothing if all are needed.
std::optional<size_t> superfluous(const Trial& trial, const Candidates& all, double needed) {
  const size_t count = trial.candidates.size();
  if (count < 2 || !std::isfinite(trial.fit.chi2)) return std::nullopt;
  std::vector<double> beyond(count);
  for (size_t i = 0; i < count; ++i) beyond[i] = beyond_physics(trial, all, i);
  const auto farthest = std::ranges::max_element(beyond);
  if (*farthest > 0.0) return static_cast<size_t>(farthest - beyond.begin());
  const auto least = std::ranges::min_element(trial.significance);
  if (least == trial.significance.end() || !(*least < needed)) return std::nullopt;
  return static_cast<size_t>(least - trial.significance.begin());
}

// In short pieces friction and drag by several powers of the rate are nearly collinear: they fit
// with opposite signs and diverge in longer pieces. Superfluous laws are therefore removed.
Trial without_superfluous(Trial trial, const Candidates& all, const std::vector<Observation>& runs,
                          double needed = 2.0) {
  while (const std::optional<size_t> least = superfluous(trial, all, needed)) {
    Trial fewer = all.assemble(trial, inference::members_of(all.terms_of(trial), *least), runs,
                               inference::until_convergence(all.limits));
    if (!std::isfinite(fewer.fit.chi2)) break;
    trial = std::move(fewer);
  }
  return trial;
}

// Fits the needed laws to pieces of increasing length. Short pieces give only rough values.
Trial lengthened(const Trial& in_pieces, const inference::RunSet<Candidates>& pieces,
                 const Candidates& all, const std::vector<Observation>& runs) {
  Trial found = without_superfluous(in_pieces, all, pieces.runs);
  for (const size_t count : std::views::reverse(all.limits.search.pieces)) {
    const std::vector<Observation> longer =
        count < pieces.pieces ? all.cut(runs, count) : std::vector<Observation>();
    if (longer.empty()) continue;
    Trial next = all.refit(found, longer, all.initial_conditions_from_data(found, longer),
                           inference::until_convergence(all.limits));
    if (!std::isfinite(next.fit.chi2)) continue;
    found = without_superfluous(std::move(next), all, longer);
  }
  return found;
}

size_t most_readings(const std::vector<Observation>& runs) {
  size_t most = 0;
  for (const Observation& seen : runs) most = std::max(most, seen.blocks());
  return most;
}

// Pieces in which the nominal model stays near the readings. If it diverges in all usual pieces,
// the shortest pieces that determine their initial conditions are returned.
std::pair<inference::RunSet<Candidates>, Trial> near_short_pieces(
    const Candidates& all, const Trial& nominal, const std::vector<Observation>& runs) {
  auto near = inference::near_pieces(all, nominal, runs);
  const size_t count = most_readings(runs) / all.limits.search.min_readings_of_piece;
  if (!inference::has_diverged(near.second, all.limits) || count <= near.first.pieces) return near;
  inference::RunSet<Candidates> pieces{all.cut(runs, count), count};
  if (pieces.runs.empty()) return near;
  Trial parted =
      all.refit(nominal, pieces.runs, all.initial_conditions_from_data(nominal, pieces.runs), {});
  return {std::move(pieces), std::move(parted)};
}

// Fits the laws to the whole recordings, starting from their strengths along the recorded curve.
// Growing windows are used if a direct fit does not converge.
std::optional<Trial> fit_from_curve(const Trial& nominal, const std::vector<size_t>& laws,
                                    const Candidates& all, const std::vector<Observation>& runs) {
  const LawsOfCurve curve = laws_of_curve(nominal, all, laws, runs);
  if (curve.members.empty()) return std::nullopt;
  const Trial stated = all.with_initial_conditions(as_stated(nominal), curve.starts);
  std::optional<Trial> best;
  for (const std::vector<double>& windows :
       {std::vector<double>{1.0}, std::vector<double>{0.1, 0.3, 1.0}}) {
    inference::Effort effort = inference::until_convergence(all.limits);
    effort.windows = windows;
    Trial trial = all.assemble(stated, curve.members, runs, effort);
    if (std::isfinite(trial.fit.chi2) && !(best && best->fit.chi2 <= trial.fit.chi2)) {
      best = std::move(trial);
    }
    if (best && best->fit.chi2_per_sample() < all.limits.diverged_chi2_per_sample) break;
  }
  return best;
}

// Fits all laws to short pieces, then to longer ones, finally to the whole recordings.
std::optional<Trial> fit_growing(const Trial& nominal, const inference::Members<Start>& members,
                                 const Candidates& all, const RecordedData& data) {
  inference::Effort growing = inference::until_convergence(all.limits);
  growing.windows = {0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0};
  Trial found = nominal;
  // With rates alone, a piece does not determine its initial angle; the whole recording does.
  const bool sees_angle = std::ranges::all_of(
      data.train, [](const Observation& seen) { return seen.has_some_attitude(); });
  if (sees_angle) {
    const auto [pieces, parted] = near_short_pieces(all, nominal, data.train);
    const Trial all_laws =
        all.assemble(parted, members, pieces.runs, inference::until_convergence(all.limits));
    const auto in_the_whole = [&](const Trial& laws) {
      return all.refit(laws, data.train, all.initial_conditions_from_data(laws, data.train),
                       growing);
    };
    // The fit to the whole recordings has a larger residual than the fit to pieces, but at most by
    // this factor.
    constexpr double alike = 100.0, useless = 0.01;
    const double near_whole = alike * std::max(1.0, all_laws.fit.chi2_per_sample());
    const auto is_near = [&] {
      return found.fit.chi2 < nominal.fit.chi2 && found.fit.chi2_per_sample() < near_whole;
    };
    found = in_the_whole(all_laws);
    if (!is_near()) {
      Trial longer = in_the_whole(lengthened(all_laws, pieces, all, data.train));
      if (!(found.fit.chi2 < longer.fit.chi2)) found = std::move(longer);
      if (!is_near() && !(found.fit.chi2 < useless * nominal.fit.chi2)) return std::nullopt;
    }
  } else {
    // Fewer readings than this hardly determine so many laws.
    constexpr double fewest_readings = 20.0;
    const size_t readings = most_readings(data.train);
    std::erase_if(growing.windows, [&](double part) {
      return part < 1.0 && part * static_cast<double>(readings) < fewest_readings;
    });
    found = all.assemble(nominal, members, data.train, growing);
  }
  // Collinear laws with opposite signs hardly fit better than laws within physical bounds. With
  // rates alone they also follow any slow change, so no law below two standard errors is kept.
  if (!is_consistent_with_noise(found.fit, data)) {
    constexpr double hardly = 2.0;
    Trial fewer = without_superfluous(found, all, data.train, sees_angle ? 0.0 : 2.0);
    const double most = sees_angle ? hardly * found.fit.chi2 : nominal.fit.chi2;
    if (fewer.fit.chi2 < most) found = std::move(fewer);
  }
  if (!(found.fit.chi2 < nominal.fit.chi2)) return std::nullopt;
  return found;
}

}  // namespace

std::optional<Trial> fit_textbook_laws(const Fit& nominal_fit, const Candidates& all,
                                       const RecordedData& data) {
  const AttitudeModel& model = nominal_fit.best.model;
  if (!model.platform.turns_about_one_axis() || model.platform.slides() ||
      !std::isfinite(nominal_fit.chi2)) {
    return std::nullopt;
  }
  inference::Members<Start> members;
  for (size_t c = 0; c < all.size(); ++c) {
    if (!all[c].is_linear || all[c].is_empirical) continue;
    const bool is_law = braking_power(all[c], model) || is_restoring(all[c], model) ||
                        all[c].effect.how.steady || all[c].start.stage == Stage::measurement;
    if (!is_law || !all[c].has_strength) continue;
    members.push_back({{c, all.start_of(c)}, {}});
  }
  if (members.empty()) return std::nullopt;
  const Trial nominal = nominal_trial(nominal_fit, all);
  const std::optional<Trial> by_curve =
      fit_from_curve(nominal, inference::candidates_of(members), all, data.train);
  if (by_curve && is_consistent_with_noise(by_curve->fit, data)) return by_curve;
  std::optional<Trial> found = fit_growing(nominal, members, all, data);
  if (by_curve && by_curve->fit.chi2 < nominal_fit.chi2 &&
      !(found && found->fit.chi2 <= by_curve->fit.chi2)) {
    return by_curve;
  }
  return found;
}

std::vector<Trial> fit_sets_of_brakes(const Trial& nominal, const Trial& found,
                                      const Candidates& all, const RecordedData& data,
                                      int threads) {
  const AttitudeModel& model = found.fit.best.model;
  inference::Members<Start> others;
  std::map<double, inference::Member<Start>> brakes;  // by the power of the rate
  const auto power_of = [&](size_t c) -> std::optional<double> {
    const auto power = all[c].is_linear ? braking_power(all[c], model) : std::nullopt;
    return power ? std::optional(0.5 * std::round(2.0 * *power)) : std::nullopt;
  };
  for (size_t c = 0; c < all.size(); ++c) {
    const inference::Member<Start> brake{{c, all.start_of(c)}, {}};
    if (const auto power = power_of(c)) brakes.emplace(*power, brake);
  }
  for (const auto& term : all.terms_of(found)) {
    const auto power = power_of(term.candidate);
    (power ? brakes[*power] : others.emplace_back()) = {term, {}};
  }
  // Sets of powers. A power of 1.5 is an empirical mean of 1 and 2, so sums do not need it.
  std::vector<inference::Members<Start>> sets;
  for (const auto& [power, brake] : brakes) sets.push_back({brake});
  std::erase_if(brakes, [](const auto& b) { return b.first != std::round(b.first); });
  const size_t count = brakes.size();
  for (size_t bits = 1; bits < (size_t{1} << count); ++bits) {
    inference::Members<Start> set;
    size_t bit = 0;
    for (const auto& [power, brake] : brakes) {
      if ((bits >> bit++ & 1) != 0) set.push_back(brake);
    }
    if (set.size() > 1) sets.push_back(std::move(set));
  }
  std::vector<Trial> trials(sets.size());
  parallel_for(sets.size(), threads, [&](size_t i) {
    inference::Members<Start> members = others;
    members.insert(members.end(), sets[i].begin(), sets[i].end());
    const inference::Effort growing{.windows = all.limits.fitting.diverged_windows};
    trials[i] = all.assemble(found, members, data.train, growing);
    const LawsOfCurve curve =
        laws_of_curve(nominal, all, inference::candidates_of(members), data.train);
    if (curve.members.size() != members.size()) return;
    const Trial stated = all.with_initial_conditions(as_stated(nominal), curve.starts);
    Trial by_curve = all.assemble(stated, curve.members, data.train, {});
    if (by_curve.fit.chi2 < trials[i].fit.chi2) trials[i] = std::move(by_curve);
  });
  double best = inference::infinity;
  for (const Trial& t : trials) {
    if (t.objection.empty()) best = std::min(best, t.fit.chi2);
  }
  constexpr double far = 3.0;
  std::erase_if(trials,
                [&](const Trial& t) { return !t.objection.empty() || !(t.fit.chi2 < far * best); });
  return trials;
}

}  // namespace photorque
