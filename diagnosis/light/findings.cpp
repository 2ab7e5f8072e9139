#include "diagnosis/light/findings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/settings/settings.h"

namespace photorque {
namespace {

// Whether an LED effect leaves no light: the LED is then named as failed.
bool is_dark(const LightTrial& trial, const LightCandidates& all, size_t which) {
  const LightCandidate& c = all[trial.candidates[which]];
  if (c.kind.name != "led_derated") return false;
  return leaves_no_light(trial.x[which][0], trial.fit, columns_of(trial, all, which).front());
}

std::vector<std::string> light_kinds(const LightTrial& trial, const LightCandidates& all) {
  std::vector<std::string> kinds;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const LightCandidate& c = all[trial.candidates[i]];
    if (c.is_empirical) continue;
    kinds.push_back(is_dark(trial, all, i) ? "led_failed" : c.kind.name);
  }
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

std::string light_label(const LightTrial& trial, const LightCandidates& all) {
  std::string label;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    std::string name = all[trial.candidates[i]].name;
    if (is_dark(trial, all, i)) name.replace(0, name.find('['), "led_failed");
    label += (label.empty() ? "" : " and ") + name;
  }
  return label;
}

// The part of the receiver in the visible shadow of a box, at the first attitude of a recording,
// and the minimum fraction of light that remains.
struct ShadedRegion {
  double u_low = 1e300, u_high = -1e300, v_low = 1e300, v_high = -1e300, darkest = 1.0;
};

ShadedRegion shaded_region(const LightTrial& trial, const LightCandidates& all, size_t which,
                           const FittedRun& run) {
  // A grid over the receiver at the first attitude of the recording.
  constexpr int steps = 60;
  const SurfaceGrid& g = all.lab->grid();
  LightRecording grid;
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      grid.u_m.push_back(g.u_low + (g.u_high - g.u_low) * (i + 0.5) / steps);
      grid.v_m.push_back(g.v_low + (g.v_high - g.v_low) * (j + 0.5) / steps);
      grid.irradiance_W_m2.push_back(1.0);
      grid.temperature_K.push_back(298.15);
      grid.lab_from_body.push_back(run.run->recording().lab_from_body.front());
    }
  }
  const LightRun places(*all.lab, std::move(grid));
  LightTrial without = trial;
  without.x[which][0] = 0.0;
  const auto light = [&](const LightTrial& t) {
    const LightState state = state_of(t, all);
    return places.signals(state, places.fields(state, nullptr));
  };
  const std::vector<double> shaded = light(trial), open = light(without);
  constexpr double visible = 0.5;  // fraction of the deepest shadow
  ShadedRegion region;
  for (size_t i = 0; i < shaded.size(); ++i) {
    if (open[i] > 0.0) region.darkest = std::min(region.darkest, shaded[i] / open[i]);
  }
  const double half_u = 0.5 * (g.u_high - g.u_low) / steps,
               half_v = 0.5 * (g.v_high - g.v_low) / steps;
  for (size_t i = 0; i < shaded.size(); ++i) {
    if (!(open[i] > 0.0)) continue;
    if (1.0 - shaded[i] / open[i] < visible * (1.0 - region.darkest)) continue;
    const double u = places.recording().u_m[i], v = places.recording().v_m[i];
    region.u_low = std::min(region.u_low, u - half_u);
    region.u_high = std::max(region.u_high, u + half_u);
    region.v_low = std::min(region.v_low, v - half_v);
    region.v_high = std::max(region.v_high, v + half_v);
  }
  return region;
}

void add_shadow(const LightTrial& trial, const LightCandidates& all, size_t which,
                const std::vector<FittedRun>& runs, FoundEffect& effect) {
  const auto scan = std::ranges::find_if(runs, [](const FittedRun& run) {
    return run.run->recording().kind == LightRecording::Kind::scan;
  });
  if (scan == runs.end()) return;
  const ShadedRegion region = shaded_region(trial, all, which, *scan);
  effect.parameters.push_back({"u_m", {region.u_low, region.u_high}, {}});
  effect.parameters.push_back({"v_m", {region.v_low, region.v_high}, {}});
  effect.parameters.push_back({"darkest", {region.darkest}, {}});
  const bool on_body = all[trial.candidates[which]].index == 1;
  effect.texts.emplace_back("axes", on_body ? "body" : "lab");
}

FoundEffect found_light_effect(const LightTrial& trial, const LightCandidates& all, size_t which,
                               const std::vector<FittedRun>& runs) {
  const LightCandidate& c = all[trial.candidates[which]];
  FoundEffect effect;
  effect.kind = c.kind.name;
  effect.explanation = c.kind.explanation;
  if (c.kind.index == LightEffectKind::Index::wall) {
    effect.texts.emplace_back("node", all.lab->walls()[c.index].node);
  } else if (c.kind.is_numbered()) {
    effect.parameters.push_back({"index", {static_cast<double>(c.index)}, {}});
  }
  if (is_dark(trial, all, which)) {
    effect.kind = "led_failed";
    effect.explanation = "an LED gives no light";
    effect.indistinguishable_from.push_back("led_derated");
    return effect;
  }
  const Eigen::MatrixXd covariance = trial.fit.shared_posterior();
  const std::vector<Eigen::Index> columns = columns_of(trial, all, which);
  size_t column = 0;
  for (size_t k = 0; k < c.numbers.size(); ++k) {
    const EffectParameter& p = c.kind.parameters[c.numbers[k].parameter];
    double sigma = 0.0;
    if (c.numbers[k].is_fitted) {
      const Eigen::Index at = columns[column++];
      sigma = std::sqrt(std::max(0.0, covariance(at, at)));
    }
    const double to_SI = unit_of_key(p.key).to_SI, x = trial.x[which][k];
    if (effect.parameters.empty() || effect.parameters.back().key != p.key) {
      effect.parameters.push_back({p.key, {}, {}, p.neutral});
    }
    effect.parameters.back().value.push_back(value_of(p, x) / to_SI);
    if (c.numbers[k].is_fitted) {
      effect.parameters.back().sigma.push_back(std::abs(slope_of(p, x)) * sigma / to_SI);
    }
  }
  if (c.kind.scan == LightEffectKind::Scan::shadow) add_shadow(trial, all, which, runs, effect);
  return effect;
}

}  // namespace

std::vector<FoundEffect> found_light_effects(const LightAnswer& answer,
                                             const std::vector<FittedRun>& runs) {
  const LightTrial& chosen = answer.chosen();
  std::vector<FoundEffect> effects;
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    if (answer.all[chosen.candidates[i]].is_empirical) continue;
    FoundEffect effect = found_light_effect(chosen, answer.all, i, runs);
    const inference::Name& name = answer.decision.names[i];
    effect.probability = name.probability;
    for (const size_t c : name.equal_places) {
      const auto index = static_cast<double>(answer.all[c].index);
      for (FittedParameter& p : effect.parameters) {
        if (p.key == "index") p.value.push_back(index);
      }
    }
    for (const std::string& rival : light_rivals(answer, i, runs)) {
      auto& known = effect.indistinguishable_from;
      if (rival != effect.kind && std::ranges::find(known, rival) == known.end()) {
        known.push_back(rival);
      }
    }
    effects.push_back(std::move(effect));
  }
  return effects;
}

std::vector<Alternative> light_alternatives(const LightAnswer& answer) {
  constexpr size_t most = 25;
  std::map<std::string, const LightTrial*> best;
  for (const LightTrial& t : answer.trials) {
    const LightTrial*& known = best[light_label(t, answer.all)];
    if (known == nullptr || t.log_evidence > known->log_evidence) known = &t;
  }
  std::vector<Alternative> result;
  for (const auto& [label, t] : best) {
    Alternative a;
    a.kinds = light_kinds(*t, answer.all);
    a.label = label;
    a.holdout_chi2_per_sample = t->holdout_chi2_per_sample;
    a.log_evidence_relative = t->log_evidence - answer.trials.front().log_evidence;
    a.remark = t->objection;
    a.chosen = label == light_label(answer.chosen(), answer.all);
    result.push_back(std::move(a));
  }
  std::ranges::stable_sort(result, std::greater(), &Alternative::log_evidence_relative);
  if (result.size() > most) result.resize(most);
  return result;
}

std::vector<Where::Dependence> light_dependences(const LightTrial& about,
                                                 const LightCandidates& all,
                                                 const std::vector<FittedRun>& runs) {
  std::map<std::string, double> strength;
  double chi2 = 0.0, samples = 0.0;
  for (const FittedRun& run : runs) {
    const Eigen::VectorXd residuals = residuals_of(about, all, run);
    chi2 += residuals.squaredNorm();
    samples += static_cast<double>(residuals.size());
  }
  const double beyond = std::max(1.0, chi2 - samples);
  for (size_t i = 0; i < all.list.size(); ++i) {
    const LightCandidate& c = all[i];
    if (!c.is_empirical || !c.is_linear) continue;
    const auto n = static_cast<Eigen::Index>(c.parameters);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    for (const FittedRun& run : runs) {
      const LightSlopes s = slopes_of(about, all, {{i, {c.start()}}}, run);
      const Eigen::MatrixXd J = s.slopes.rightCols(n);
      H += J.transpose() * J;
      g += J.transpose() * s.residuals;
    }
    const double gain = linear_gain(H, g) - static_cast<double>(g.size());
    if (std::isfinite(gain)) {
      strength[c.variable] = std::max(strength[c.variable], std::clamp(gain / beyond, 0.0, 1.0));
    }
  }
  std::vector<Where::Dependence> result;
  for (const auto& [variable, s] : strength) {
    if (s > all.limits.location.min_dependence) result.push_back({variable, s});
  }
  std::ranges::stable_sort(result, std::greater(), &Where::Dependence::strength);
  return result;
}

std::vector<FittedParameter> refined_light_priors(const LightAnswer& answer) {
  std::vector<FittedParameter> refined;
  const std::vector<LightPrior>& priors = answer.all.nominal.uncertain;
  if (priors.empty()) return refined;
  const LightTrial& chosen = answer.chosen();
  const Eigen::MatrixXd covariance = chosen.fit.shared_posterior();
  for (size_t i = 0; i < priors.size(); ++i) {
    const LightPrior& b = priors[i];
    if (refined.empty() || refined.back().key != b.key) {
      refined.push_back({b.key, b.value, std::vector<double>(b.value.size(), 0.0)});
    }
    // A value stated at the end of its range stays within the range.
    double errors = chosen.priors[i];
    if (!(b.low.errors < 0.0)) errors = std::max(errors, 0.0);
    if (!(b.high.errors > 0.0)) errors = std::min(errors, 0.0);
    const auto k = static_cast<Eigen::Index>(i);
    refined.back().value[b.component] += errors * b.sigma;
    refined.back().sigma[b.component] = b.sigma * std::sqrt(std::max(0.0, covariance(k, k)));
  }
  return refined;
}

std::string light_sentence(const Diagnosis& d) {
  if (d.verdict == Verdict::consistent) {
    return "Nothing is missing: the differences are noise or lie within the stated uncertainty.";
  }
  if (d.verdict == Verdict::missing_physics) {
    std::string text = d.effects.size() == 1 ? "Missing: " : "Missing together: ";
    for (size_t i = 0; i < d.effects.size(); ++i) {
      const FoundEffect& e = d.effects[i];
      std::string name = in_words(e.kind);
      for (const FittedParameter& p : e.parameters) {
        if (p.key != "index") continue;
        for (size_t k = 0; k < p.value.size(); ++k) {
          name += (k > 0 ? " or " : " ") + std::to_string(static_cast<int>(p.value[k]));
        }
      }
      text += (i > 0 ? "; " : "") + name + " (" + e.explanation + ")";
    }
    return text + ".";
  }
  std::string text = "Not explained: no effect of the catalogue explains the recording";
  if (!d.where.depends_on.empty()) text += "; it depends on " + d.where.depends_on.front().variable;
  if (!d.because.empty()) text += " (" + d.because + ")";
  return text + ".";
}

}  // namespace photorque
