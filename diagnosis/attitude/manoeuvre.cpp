#include "diagnosis/attitude/findings.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "attitude/disturbances/kind.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/parallel.h"

namespace photorque {

namespace {

using StartChange = std::function<void(PlatformState&)>;

// A change of the initial state of a run.
struct StartManoeuvre {
  const char* text;
  StartChange change;
};

// Minimum rate after a spin-up.
constexpr double brisk_rad_s = 0.3;

void spin_up(PlatformState& state) {
  const double rate = state.rate_body_rad_s.norm();
  if (rate == 0.0) {
    state.rate_body_rad_s = Vec3(0, 0, brisk_rad_s);
  } else {
    state.rate_body_rad_s *= std::max(3.0, brisk_rad_s / rate);
  }
}

void increase_tilt(PlatformState& state) {
  const Vec3 up_body = state.lab_from_body.conjugate() * Vec3::UnitZ();
  const Vec3 across = up_body.cross(Vec3::UnitZ());  // away from the vertical
  const Vec3 axis = across.norm() > 1e-6 ? Vec3(across.normalized()) : Vec3::UnitX();
  state.lab_from_body = state.lab_from_body * Quat(Eigen::AngleAxisd(0.2, axis));
}

std::vector<StartManoeuvre> start_manoeuvres() {
  return {
      {"spin the platform up to three times its present rate, 0.3 rad/s at least, and let it run "
       "down: laws of drag and errors of gyros increase differently with the rate",
       spin_up},
      {"repeat the run with the opposite sense of rotation: a driving torque keeps its sign, "
       "friction changes it",
       [](PlatformState& state) { state.rate_body_rad_s = -state.rate_body_rad_s; }},
      {"repeat the run from a yaw a quarter turn further: effects fixed to the body turn with "
       "it, those fixed to the room do not",
       [](PlatformState& state) {
         state.lab_from_body = Eigen::AngleAxisd(0.5 * pi, Vec3::UnitZ()) * state.lab_from_body;
       }},
      {"start the run at 0.2 rad more tilt: righting torques deviate from the sine differently",
       increase_tilt},
  };
}

constexpr const char* longer = "record longer, at larger tilt and over a wider range of rates";

// Whether only the battery current distinguishes two kinds: effects of its charge do not depend on
// the initial state.
bool is_separated_by_charge(const std::string& kind, const std::string& rival) {
  const auto lists = [](const std::string& one, const std::string& other) {
    const DisturbanceKind* known = find_kind(one);
    return known != nullptr &&
           std::ranges::any_of(known->screening.confusable_kinds, [&](const ConfusableKind& l) {
             return l.kind == other && l.distinguished_by == Requirement::charge;
           });
  };
  return lists(kind, rival) || lists(rival, kind);
}

// Synthetic noise-free readings of the first run from another initial state, propagated by the
// trial.
Observation propagated_from(const Trial& truth, const PlatformState& start,
                            const Observation& like) {
  PredictionOptions options;
  options.keep_residuals = true;
  const Dynamics dynamics(truth.fit.best.model_of(0, like));
  const Prediction propagated = predict(dynamics, start, like, {}, options);
  Observation seen = like;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const Vec3& offset = propagated.camera_offset_lab_rad[i];
    seen.attitude[i] = propagated.states[i].lab_from_body;
    if (const double angle = offset.norm(); angle > 0.0) {
      seen.attitude[i] = Quat(Eigen::AngleAxisd(angle, offset / angle)) * seen.attitude[i];
    }
    seen.gyro_rad_s[i] = propagated.gyro_rad_s[i];
  }
  return seen;
}

// The rival fitted to the existing recordings, averaged into fewer blocks.
struct Rival {
  Trial fitted;
  std::vector<Observation> runs;

  Rival(const Trial& trial, const Candidates& all, const std::vector<Observation>& recorded) {
    const size_t blocks = all.limits.fitting.slow_blocks;
    for (const Observation& seen : recorded) runs.push_back(seen.averaged(blocks));
    fitted = all.refit(trial, runs, trial.fit.best.runs);
  }
};

constexpr double not_known = -1.0;

// Half of the growth of the rival's χ² by the manoeuvre; not_known if its fit does not converge.
double expected_lead(const Trial& truth, const Rival& rival, const Candidates& all,
                     const StartChange& change) {
  try {
    PlatformState start = truth.fit.best.runs.front().initial;
    change(start);
    std::vector<Observation> runs = rival.runs;
    runs.push_back(propagated_from(truth, start, rival.runs.front()));
    std::vector<RunStart> starts = rival.fitted.fit.best.runs;
    starts.push_back(starts.front());
    starts.back().initial = start;
    const Trial both =
        all.refit(rival.fitted, runs, starts, {.windows = all.limits.fitting.added_windows});
    if (!both.fit.converged) return not_known;
    const double more =
        both.fit.chi2 - rival.fitted.fit.chi2;  // includes the cost of shifted priors
    return std::isfinite(more) ? std::max(0.0, 0.5 * more) : not_known;
  } catch (const NumericalError&) {
    return not_known;
  }
}

// The start with the largest expected lead.
Manoeuvre best_start(Manoeuvre m, const Trial& truth, const Trial& rival, const Candidates& all,
                     const std::vector<Observation>& recorded, int threads) {
  const std::vector<StartManoeuvre> known = start_manoeuvres();
  const Rival other(rival, all, recorded);
  std::vector<double> lead(known.size());
  parallel_for(known.size(), threads,
               [&](size_t i) { lead[i] = expected_lead(truth, other, all, known[i].change); });
  const auto best = static_cast<size_t>(std::max_element(lead.begin(), lead.end()) - lead.begin());
  if (lead[best] == not_known) return m;
  m.log_evidence_expected = lead[best];
  m.text = known[best].text;
  if (lead[best] < all.limits.search.min_log_evidence_gain) {
    m.text = std::string(longer) +
             "; none of four other initial states would distinguish them; the best of the four: " +
             m.text;
  }
  return m;
}

// The best trial with `rival` in place of `kind`.
const Trial* best_with_rival(const std::string& kind, const std::string& rival, const Trial& chosen,
                             const std::vector<Trial>& trials, const Candidates& all) {
  const auto labels_of = [&](const Trial& t) {
    std::multiset<std::string> kinds;
    for (const size_t c : t.candidates) kinds.insert(all[c].name);
    return kinds;
  };
  std::multiset<std::string> wanted = labels_of(chosen);
  wanted.erase(wanted.find(kind));
  wanted.insert(rival);
  const Trial* best = nullptr;
  for (const Trial& t : trials) {
    if (labels_of(t) != wanted) continue;
    if (best == nullptr || t.log_evidence > best->log_evidence) best = &t;
  }
  return best;
}

}  // namespace

std::vector<Manoeuvre> manoeuvres(const std::vector<FoundEffect>& effects,
                                  const inference::Decision& decision,
                                  const std::vector<Trial>& trials, const Candidates& all,
                                  const std::vector<Observation>& runs, int threads) {
  const Trial& chosen = trials[decision.chosen];
  std::vector<Manoeuvre> result;
  // All known manoeuvres turn the platform.
  if (chosen.fit.best.model.platform.slides()) return result;
  for (const FoundEffect& effect : effects) {
    for (const std::string& rival : effect.indistinguishable_from) {
      Manoeuvre m{{effect.kind, rival}, longer, 0.0};
      const Trial* other = best_with_rival(effect.kind, rival, chosen, trials, all);
      if (is_separated_by_charge(effect.kind, rival)) {
        m.text =
            "record through a change of the battery current: only the effect of the discharge "
            "follows the charge";
      } else if (other != nullptr) {
        m = best_start(std::move(m), chosen, *other, all, runs, threads);
      }
      result.push_back(std::move(m));
    }
  }
  return result;
}

}  // namespace photorque
