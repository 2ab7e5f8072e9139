#include "diagnosis/account.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/constants.h"

namespace photorque {
namespace {

// Difference of log evidence below which two explanations count as equally good.
constexpr double same_log_evidence = 3.0;

std::vector<std::string> kinds_of(const Trial& t, const std::vector<Candidate>& all) {
  std::vector<std::string> kinds;
  for (const size_t c : t.candidates) {
    if (!all[c].empirical()) kinds.push_back(all[c].effect.kind);
  }
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

std::string label_of(const Trial& t, const std::vector<Candidate>& all) {
  std::string label;
  for (const size_t c : t.candidates) {
    if (!label.empty()) label += " and ";
    label += all[c].label;
  }
  return label;
}

// Values and standard errors of one disturbance by key, in the keys' units.
std::vector<FittedParameter> parameters_of(const Trial& t, size_t disturbance) {
  const Eigen::MatrixXd covariance = t.fit.shared_covariance();
  const auto& parameters = t.fit.best.model.disturbances[disturbance].parameters;
  std::vector<FittedParameter> result;
  for (size_t p = 0; p < parameters.size(); ++p) {
    Eigen::Index shared = 0, at = -1;
    for (const Free& f : t.fit.best.free) {
      if (f.per_run) continue;
      if (f.disturbance == disturbance && f.parameter == static_cast<int>(p)) at = shared;
      ++shared;
    }
    if (at < 0) continue;
    const double unit = unit_of_key(parameters[p].key).to_SI;
    if (result.empty() || result.back().key != parameters[p].key) {
      result.push_back({parameters[p].key, {}, {}});
    }
    result.back().value.push_back(parameters[p].value / unit);
    result.back().sigma.push_back(std::sqrt(std::max(0.0, covariance(at, at))) / unit);
  }
  return result;
}

// Kinds that stand in for `kind` in an equally good trial that is otherwise the same.
std::vector<std::string> rivals(const std::string& kind, const Trial& chosen,
                                const std::vector<Trial>& trials,
                                const std::vector<Candidate>& all) {
  std::vector<std::string> others = kinds_of(chosen, all);
  others.erase(std::find(others.begin(), others.end(), kind));
  std::set<std::string> result;
  for (const Trial& t : trials) {
    if (!t.objection.empty() || t.candidates.size() != chosen.candidates.size()) continue;
    if (t.log_evidence < chosen.log_evidence - same_log_evidence) continue;
    std::vector<std::string> kinds = kinds_of(t, all);
    if (kinds.size() != t.candidates.size()) continue;
    for (const std::string& other : others) {
      const auto at = std::find(kinds.begin(), kinds.end(), other);
      if (at != kinds.end()) kinds.erase(at);
    }
    if (kinds.size() == 1 && kinds.front() != kind) result.insert(kinds.front());
  }
  return {result.begin(), result.end()};
}

}  // namespace

std::vector<FoundEffect> found_effects(const Decision& decision, const std::vector<Trial>& trials,
                                       const std::vector<Candidate>& all) {
  const Trial& chosen = trials[decision.chosen];
  std::vector<FoundEffect> effects;
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    const Candidate& c = all[chosen.candidates[i]];
    if (c.empirical()) continue;
    FoundEffect effect;
    effect.kind = c.effect.kind;
    effect.explanation = c.effect.explanation;
    effect.parameters = parameters_of(chosen, chosen.disturbances[i]);
    for (size_t t = 0; t < trials.size(); ++t) {
      const std::vector<std::string> kinds = kinds_of(trials[t], all);
      if (std::find(kinds.begin(), kinds.end(), effect.kind) != kinds.end()) {
        effect.probability += decision.probability[t];
      }
    }
    effect.probability = std::min(1.0, effect.probability);
    effect.indistinguishable_from = rivals(effect.kind, chosen, trials, all);
    effects.push_back(std::move(effect));
  }
  return effects;
}

std::vector<Alternative> alternatives(const std::vector<Trial>& trials,
                                      const std::vector<Candidate>& all) {
  constexpr size_t most = 25;
  std::map<std::string, const Trial*> best;
  for (const Trial& t : trials) {
    const Trial*& known = best[label_of(t, all)];
    if (known == nullptr || t.log_evidence > known->log_evidence) known = &t;
  }
  std::vector<Alternative> result;
  for (const auto& [label, t] : best) {
    Alternative a;
    a.kinds = kinds_of(*t, all);
    // Kinds say all of what is physics alone.
    if (a.kinds.size() != t->candidates.size()) a.label = label;
    a.log_evidence_relative = t->log_evidence - trials.front().log_evidence;
    a.remark = t->objection;
    result.push_back(std::move(a));
  }
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) {
    return a.log_evidence_relative > b.log_evidence_relative;
  });
  if (result.size() > most) result.resize(most);
  return result;
}

std::vector<FittedParameter> refined_beliefs(const Trial& chosen) {
  std::vector<FittedParameter> result;
  const size_t believed =
      chosen.disturbances.empty()
          ? chosen.fit.best.model.disturbances.size()
          : *std::min_element(chosen.disturbances.begin(), chosen.disturbances.end());
  for (size_t d = 0; d < believed; ++d) {
    for (FittedParameter& p : parameters_of(chosen, d)) {
      p.key = "disturbance[" + std::to_string(d) + "]." + p.key;
      result.push_back(std::move(p));
    }
  }
  return result;
}

std::vector<EmpiricalTorque> empirical_torques(const Trial& chosen,
                                               const std::vector<Candidate>& all,
                                               const std::vector<Observation>& runs) {
  constexpr size_t bins = 36;
  std::vector<EmpiricalTorque> result;
  const AttitudeModel model = chosen.fit.best.model_of(0, runs.front());
  const Dynamics dynamics(model);
  const std::vector<double> times_s = runs.front().averaged(1000).time_s;
  PlatformState initial = chosen.fit.best.runs.front().initial;
  const Trajectory flown = propagate(dynamics, initial, times_s, {.tolerance = 1e-7});
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    const Candidate& c = all[chosen.candidates[i]];
    if (!c.empirical()) continue;
    EmpiricalTorque torque;
    torque.variable = c.variable;
    const bool heading = c.variable == "heading", tilt = c.variable == "tilt";
    torque.unit = heading || tilt           ? "deg"
                  : c.variable == "rate"    ? "rad/s"
                  : c.variable == "charge"  ? "C"
                  : c.variable == "command" ? "N m"
                                            : "s";
    torque.about_lab_axes = heading;
    std::vector<double> x;
    std::vector<Vec3> y;
    for (const PlatformState& state : flown.states) {
      const Vec3 body = disturbance_torques_body_N_m(model, state)[chosen.disturbances[i]];
      y.push_back(heading ? Vec3(state.lab_from_body * body) : body);
      x.push_back(heading                  ? heading_rad(state) / degree_rad
                  : tilt                   ? tilt_rad(state) / degree_rad
                  : c.variable == "rate"   ? state.rate_body_rad_s.norm()
                  : c.variable == "charge" ? state.charge_drawn_C
                  : c.variable == "command"
                      ? model.schedule.at(state.time_s).command_body_N_m.norm()
                      : state.time_s);
    }
    const auto [low, high] = std::minmax_element(x.begin(), x.end());
    const double width = (*high - *low) / bins;
    std::vector<Vec3> sum(bins, Vec3::Zero());
    std::vector<double> count(bins, 0.0);
    for (size_t k = 0; k < x.size(); ++k) {
      const auto bin =
          std::min(bins - 1, static_cast<size_t>((x[k] - *low) / std::max(width, 1e-300)));
      sum[bin] += y[k];
      count[bin] += 1.0;
    }
    for (size_t bin = 0; bin < bins; ++bin) {
      if (count[bin] == 0.0) continue;
      torque.at.push_back(*low + (static_cast<double>(bin) + 0.5) * width);
      torque.torque_N_m.push_back(sum[bin] / count[bin]);
    }
    result.push_back(std::move(torque));
  }
  return result;
}

std::vector<Manoeuvre> manoeuvres(const std::vector<FoundEffect>& effects) {
  struct Advice {
    std::set<std::string> kinds;
    const char* text;
  };
  const std::vector<Advice> all = {
      {{"bearing_drag", "air_friction", "air_pressure_drag", "dry_friction", "eddy_damping"},
       "spin the platform up to several times the present rate and let it run down to rest: the "
       "laws of drag differ in their power of the rate"},
      {{"turbine_torque", "dry_friction", "room_draft"},
       "repeat the run with the opposite sense of rotation: a driving torque keeps its sign, "
       "friction changes it"},
      {{"room_draft", "magnetic_dipole", "static_unbalance", "gravity_tilt"},
       "repeat the run with the platform starting a quarter turn further about the vertical: what "
       "is fixed to the body turns with it"},
      {{"elastic_sag", "static_unbalance", "gravity_gradient", "inertia_error"},
       "swing the platform to a larger tilt: the righting torque departs from the sine"},
      {{"battery_discharge", "mass_shift", "static_unbalance"},
       "record through a change of the battery current: only a shift by discharge follows the "
       "charge"},
      {{"gyro_scale", "gyro_misalignment", "gyro_bias", "camera_misalignment", "attitude_latency"},
       "turn about each body axis in both senses at several rates: the instruments' errors "
       "separate by axis, sign and rate"},
  };
  std::vector<Manoeuvre> result;
  for (const FoundEffect& effect : effects) {
    for (const std::string& rival : effect.indistinguishable_from) {
      Manoeuvre m{{effect.kind, rival},
                  "record longer, at larger tilt and over a wider range of rates",
                  0.0};
      for (const Advice& advice : all) {
        if (advice.kinds.contains(effect.kind) && advice.kinds.contains(rival))
          m.text = advice.text;
      }
      result.push_back(std::move(m));
    }
  }
  return result;
}

std::string sentence_of(const Diagnosis& d) {
  if (d.verdict == Verdict::consistent) {
    return "Nothing is missing: what differs is noise or lies within the stated uncertainty.";
  }
  if (d.verdict == Verdict::missing_physics) {
    std::string text = d.effects.size() == 1 ? "Missing: " : "Missing together: ";
    for (size_t i = 0; i < d.effects.size(); ++i) {
      if (i > 0) text += "; ";
      text += d.effects[i].kind + " (" + d.effects[i].explanation + ")";
    }
    return text + ".";
  }
  std::string text = "Something acts that no effect of the catalogue explains";
  if (!d.where.depends_on.empty()) {
    text += "; it depends on " + d.where.depends_on.front().variable;
  }
  return text + ".";
}

}  // namespace photorque
