#include "diagnosis/manoeuvre.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/constants.h"
#include "core/errors.h"

namespace photorque {
namespace {

using StartChange = std::function<void(PlatformState&)>;

struct Advice {
  std::set<std::string> kinds;
  const char* text;
  StartChange start;  // of the run; empty: the manoeuvre is not one of its start
};

// How fast a platform is spun up, at least.
constexpr double brisk_rad_s = 0.3;

void spin_up(PlatformState& state) {
  const double rate = state.rate_body_rad_s.norm();
  if (rate == 0.0) {
    state.rate_body_rad_s = Vec3(0, 0, brisk_rad_s);
  } else {
    state.rate_body_rad_s *= std::max(3.0, brisk_rad_s / rate);
  }
}

void turn_back(PlatformState& state) {
  state.rate_body_rad_s = -state.rate_body_rad_s;
}

void turn_a_quarter(PlatformState& state) {
  state.lab_from_body = Quat(Eigen::AngleAxisd(0.5 * pi, Vec3::UnitZ())) * state.lab_from_body;
}

void lean_further(PlatformState& state) {
  state.lab_from_body = state.lab_from_body * Quat(Eigen::AngleAxisd(0.2, Vec3::UnitX()));
}

std::vector<Advice> advice() {
  return {
      {{"bearing_drag", "air_friction", "air_pressure_drag", "dry_friction", "eddy_damping"},
       "spin the platform up to three times the present rate, 0.3 rad/s at least, and let it run "
       "down: the laws of drag differ in their power of the rate",
       spin_up},
      {{"turbine_torque", "dry_friction", "room_draft"},
       "repeat the run with the opposite sense of rotation: a driving torque keeps its sign, "
       "friction changes it",
       turn_back},
      {{"room_draft", "magnetic_dipole", "static_unbalance", "gravity_tilt"},
       "repeat the run with the platform starting a quarter turn further about the vertical: what "
       "is fixed to the body turns with it",
       turn_a_quarter},
      {{"elastic_sag", "static_unbalance", "gravity_gradient", "inertia_error"},
       "start the run at 0.2 rad more tilt: the righting torque departs from the sine",
       lean_further},
      {{"battery_discharge", "mass_shift", "static_unbalance"},
       "record through a change of the battery current: only a shift by discharge follows the "
       "charge",
       {}},
      {{"gyro_scale", "gyro_misalignment", "gyro_bias", "camera_misalignment", "attitude_latency"},
       "turn about each body axis in both senses, three times as fast: the instruments' errors "
       "separate by axis, sign and rate",
       spin_up},
  };
}

// The first run from another start as the trial foretells it, without noise.
Observation flown_from(const Trial& truth, const PlatformState& start, const Observation& like) {
  PredictionOptions options;
  options.keep_residuals = true;
  const Dynamics dynamics(truth.fit.best.model_of(0, like));
  const Prediction flown = predict(dynamics, start, like, {}, options);
  Observation seen = like;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const Vec3& offset = flown.camera_offset_lab_rad[i];
    seen.attitude[i] = flown.states[i].lab_from_body;
    if (const double angle = offset.norm(); angle > 0.0) {
      seen.attitude[i] = Quat(Eigen::AngleAxisd(angle, offset / angle)) * seen.attitude[i];
    }
    seen.gyro_rad_s[i] = flown.gyro_rad_s[i];
  }
  return seen;
}

double expected_lead(const Trial& truth, const Trial& rival, const std::vector<Candidate>& all,
                     const std::vector<Observation>& runs, const StartChange& change) {
  constexpr size_t blocks = 1000;
  try {
    PlatformState start = truth.fit.best.runs.front().initial;
    change(start);
    const Observation seen = flown_from(truth, start, runs.front().averaged(blocks));
    RunStart from = rival.fit.best.runs.front();
    change(from.initial);
    FitSettings growing;
    growing.windows = {0.1, 0.4, 1.0};
    const Trial fitted = refit(rival, all, {seen}, {from}, growing);
    return std::isfinite(fitted.fit.data_chi2) ? 0.5 * fitted.fit.data_chi2 : 0.0;
  } catch (const NumericalError&) {
    return 0.0;
  }
}

// The best trial in which `rival` stands in for `kind`.
const Trial* stand_in(const std::string& kind, const std::string& rival, const Trial& chosen,
                      const std::vector<Trial>& trials, const std::vector<Candidate>& all) {
  const auto labels_of = [&](const Trial& t) {
    std::multiset<std::string> kinds;
    for (const size_t c : t.candidates) kinds.insert(all[c].label);
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

std::vector<Manoeuvre> manoeuvres(const std::vector<FoundEffect>& effects, const Decision& decision,
                                  const std::vector<Trial>& trials,
                                  const std::vector<Candidate>& all,
                                  const std::vector<Observation>& runs) {
  const std::vector<Advice> known = advice();
  const Trial& chosen = trials[decision.chosen];
  std::vector<Manoeuvre> result;
  for (const FoundEffect& effect : effects) {
    for (const std::string& rival : effect.indistinguishable_from) {
      Manoeuvre m{{effect.kind, rival},
                  "record longer, at larger tilt and over a wider range of rates",
                  0.0};
      const auto fits = std::find_if(known.begin(), known.end(), [&](const Advice& a) {
        return a.kinds.contains(effect.kind) && a.kinds.contains(rival);
      });
      if (fits != known.end()) {
        m.text = fits->text;
        const Trial* other = stand_in(effect.kind, rival, chosen, trials, all);
        if (fits->start && other != nullptr) {
          m.log_evidence_expected = expected_lead(chosen, *other, all, runs, fits->start);
        }
      }
      result.push_back(std::move(m));
    }
  }
  return result;
}

}  // namespace photorque
