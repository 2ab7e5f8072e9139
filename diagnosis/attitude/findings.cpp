#include "diagnosis/attitude/findings.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "attitude/disturbances/kind.h"
#include "core/constants.h"
#include "core/text/format.h"

namespace photorque {
namespace {

std::vector<std::string> kinds_of(const Trial& t, const Candidates& all) {
  std::vector<std::string> kinds;
  for (const size_t c : t.candidates) {
    if (!all[c].is_empirical) kinds.push_back(all[c].effect.kind);
  }
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

std::string label_of(const Trial& t, const Candidates& all) {
  return joined_text(t.candidates, " and ", [&](size_t c) { return all[c].name; });
}

// The length of an axis is arbitrary: normalises the vector and keeps only its errors across the
// axis.
void make_direction(FittedParameter& axis, const Eigen::Matrix3d& covariance) {
  const Vec3 vector(axis.value[0], axis.value[1], axis.value[2]);
  const double length = vector.norm();
  if (!(length > 0.0)) return;
  const Vec3 unit = vector / length;
  const Mat3 across = Mat3::Identity() - unit * unit.transpose();
  const Mat3 error = across * covariance * across / (length * length);
  for (int k = 0; k < 3; ++k) {
    axis.value[static_cast<size_t>(k)] = unit[k];
    axis.sigma[static_cast<size_t>(k)] =
        error(k, k) >= 0.0 ? std::sqrt(error(k, k)) : std::numeric_limits<double>::infinity();
  }
}

// Kinds that replace `kind` in an equally good trial with otherwise equal effects.
std::vector<std::string> rivals(const std::string& kind, const Trial& chosen,
                                const std::vector<Trial>& trials, const Candidates& all) {
  std::vector<std::string> others = kinds_of(chosen, all);
  others.erase(std::find(others.begin(), others.end(), kind));
  std::set<std::string> result;
  for (const Trial& t : trials) {
    if (!t.objection.empty() || t.candidates.size() != chosen.candidates.size()) continue;
    if (t.log_evidence < chosen.log_evidence - all.limits.search.min_log_evidence_gain) continue;
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

// Moves fitted values to their physical bounds: a fit may exceed a bound by less than the standard
// error, but an experiment file cannot state such a value.
void keep_within_bounds(const Candidate& c, std::vector<FittedParameter>& fitted) {
  std::vector<double*> values;
  for (FittedParameter& parameter : fitted) {
    for (double& value : parameter.value) values.push_back(&value);
  }
  size_t k = 0;
  for (size_t p = 0; p < c.scale.size() && k < values.size(); ++p) {
    const Parameters& all = c.start.parameters;
    bool any_fitted = false;
    for (size_t other = 0; other < all.size(); ++other) {
      any_fitted = any_fitted || (all[other].key == all[p].key && c.is_fitted(other));
    }
    if (!any_fitted) continue;
    const double unit = unit_of_key(c.start.parameters[p].key).to_SI;
    *values[k] = std::clamp(*values[k], c.lowest[p] / unit, c.highest[p] / unit);
    ++k;
  }
}

// Identifiable combinations for each key with three free numbers, directions excepted.
std::vector<std::string> combinations(const Trial& t, size_t disturbance) {
  const auto& parameters = t.fit.best.model.disturbances[disturbance].parameters;
  std::map<std::string, std::vector<std::pair<Eigen::Index, double>>> of_key;
  for (const SharedParameter& s : t.fit.best.shared(disturbance)) {
    of_key[parameters[s.parameter].key].emplace_back(s.at, s.value);
  }
  std::vector<std::string> texts;
  if (of_key.empty()) return texts;
  const Eigen::MatrixXd covariance = t.fit.shared_posterior();
  for (const auto& [key, numbers] : of_key) {
    if (numbers.size() != 3 || key == "axis") continue;
    const double per_SI = 1.0 / unit_of_key(key).to_SI;
    Vec3 value;
    Mat3 of_three;
    for (Eigen::Index i = 0; i < 3; ++i) {
      value[i] = numbers[static_cast<size_t>(i)].second * per_SI;
      for (Eigen::Index j = 0; j < 3; ++j) {
        of_three(i, j) = covariance(numbers[static_cast<size_t>(i)].first,
                                    numbers[static_cast<size_t>(j)].first) *
                         per_SI * per_SI;
      }
    }
    const std::string text = known_together(value, of_three);
    if (!text.empty()) texts.push_back(key + ": " + text);
  }
  return texts;
}

// Initial states of a disturbance in the first run.
std::vector<FittedParameter> initial_states(const Trial& t, size_t disturbance) {
  const std::vector<Disturbance>& all = t.fit.best.model.disturbances;
  const PlatformState& initial = t.fit.best.runs.front().initial;
  auto own = initial.extra.begin();
  for (size_t d = 0; d < disturbance; ++d) own += static_cast<ptrdiff_t>(all[d].states.size());
  std::vector<FittedParameter> result;
  for (const ExtraState& state : all[disturbance].states) {
    const double value_SI = *own++;
    if (state.key.empty()) continue;
    result.push_back({state.key, {value_SI / unit_of_key(state.key).to_SI}, {}});
  }
  return result;
}

// The explanation of an effect. For a torque that restores an angle it states the natural
// frequency, √(k / I) / 2π with the steepest fall k of the torque, because an offset or a stiffness
// of a body of unknown inertia says little.
std::string explanation_of(const Candidate& c, const Trial& chosen, size_t disturbance) {
  AttitudeModel model = chosen.fit.best.model;
  if (model.platform.slides() || !is_restoring(c, model)) return c.effect.explanation;
  const Vec3& axis = model.platform.axis;
  const double inertia_kg_m2 = axis.dot(model.platform.inertia_kg_m2 * axis);
  model.disturbances = {model.disturbances[disturbance]};
  constexpr int steps = 720;
  double stiffness_N_m = 0.0, before_N_m = 0.0;
  for (int k = 0; k <= steps; ++k) {
    PlatformState state = Dynamics(model).initial_state();
    state.lab_from_body = Quat(Eigen::AngleAxisd(2.0 * pi * k / steps - pi, axis));
    const double now_N_m = axis.dot(disturbance_torques_body_N_m(model, state).front());
    if (k > 0) stiffness_N_m = std::max(stiffness_N_m, (before_N_m - now_N_m) * steps / (2.0 * pi));
    before_N_m = now_N_m;
  }
  return c.effect.explanation + ": alone, it swings at " +
         readable_number(std::sqrt(stiffness_N_m / inertia_kg_m2) / (2.0 * pi), 3) + " Hz";
}

// Moves fitted values into the range of their key, which they may leave by less than the standard
// error: an experiment file cannot state such a value.
void keep_within_range(const std::string& kind, FittedParameter& fitted) {
  const DisturbanceKind* const known = find_kind(kind);
  if (known == nullptr) return;
  const KeyUnit unit = unit_of_key(fitted.key);
  for (const Key& key : known->keys) {
    const KeyUnit same = unit_of_key(key.name);
    if (same.stem != unit.stem || same.dimension != unit.dimension) continue;
    for (double& value : fitted.value) {
      value = std::clamp(value, key.range.low / unit.to_SI, key.range.high / unit.to_SI);
    }
  }
}

// "a (explanation); b (explanation), or c or d, which these data do not distinguish from it" of all
// named effects.
std::string names_of(const Diagnosis& d) {
  return joined_text(d.effects, "; ", [](const FoundEffect& effect) {
    const std::string others = joined_text(effect.indistinguishable_from, " or ", in_words);
    return in_words(effect.kind) + " (" + effect.explanation + ")" +
           (others.empty() ? ""
                           : ", or " + others + ", which these data do not distinguish from it");
  });
}

// Sentence for named effects with an unexplained residual.
std::string mostly_explained(const Diagnosis& d) {
  std::string text = "Mostly explained by " + names_of(d);
  if (d.holdout && d.holdout->chi2_per_sample_after > 0.0) {
    const double before = d.holdout->chi2_per_sample_before,
                 after = d.holdout->chi2_per_sample_after;
    text += after < before
                ? printed(
                      ". In the held-out data, the residual (rms) is %.3g of that of the nominal "
                      "model and %.3g "
                      "times the noise; the cause of the remainder is unknown",
                      std::sqrt(after / before), std::sqrt(after))
                : std::string(
                      ". The held-out data do not show it: the nominal model predicts them "
                      "as well");
  }
  return text + ".";
}

}  // namespace

std::string known_together(const Vec3& value, const Mat3& covariance) {
  constexpr double by_itself = 2.0, beyond_doubt = 4.0, next_to_nothing = 0.005;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (!(std::abs(value[k]) <= by_itself * std::sqrt(covariance(k, k)))) return "";
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(covariance);
  double most = beyond_doubt, combined = 0.0, error = 0.0;
  Vec3 best = Vec3::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) {
    Vec3 way = principal.eigenvectors().col(k);
    Eigen::Index largest = 0;
    way.cwiseAbs().maxCoeff(&largest);
    way /= way[largest];
    const double sigma = std::sqrt(std::max(0.0, way.dot(covariance * way)));
    const double sum = way.dot(value);
    if (!(std::abs(sum) > most * sigma)) continue;
    most = std::abs(sum) / sigma;
    best = sum < 0.0 ? Vec3(-way) : way;
    combined = std::abs(sum);
    error = sigma;
  }
  if (combined == 0.0) return "";
  std::string text;
  const char* const axes[] = {"x", "y", "z"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double size = std::abs(best[k]);
    if (size < next_to_nothing) continue;
    const bool is_less = best[k] < 0.0;
    text += text.empty() ? (is_less ? "−" : "") : (is_less ? " − " : " + ");
    if (std::abs(size - 1.0) >= next_to_nothing) text += readable_number(size, 2) + " ";
    text += axes[k];
  }
  return text + " = " + with_error(combined, error);
}

std::vector<FittedParameter> fitted_parameters(const Trial& t, size_t disturbance) {
  const Eigen::MatrixXd covariance = t.fit.shared_posterior();
  const auto& parameters = t.fit.best.model.disturbances[disturbance].parameters;
  const std::vector<SharedParameter> fitted = t.fit.best.shared(disturbance);
  std::vector<FittedParameter> result;
  for (size_t p = 0; p < parameters.size(); ++p) {
    const bool key_is_fitted = std::ranges::any_of(fitted, [&](const SharedParameter& s) {
      return parameters[s.parameter].key == parameters[p].key;
    });
    if (!key_is_fitted) continue;
    const auto own = std::ranges::find(fitted, p, &SharedParameter::parameter);
    const Eigen::Index at = own == fitted.end() ? -1 : own->at;
    const double unit = unit_of_key(parameters[p].key).to_SI;
    if (result.empty() || result.back().key != parameters[p].key) {
      result.push_back({parameters[p].key, {}, {}});
    }
    result.back().value.push_back(parameters[p].value / unit);
    // A component that the data do not determine keeps its nominal value.
    result.back().sigma.push_back(at < 0 ? 0.0
                                         : std::sqrt(std::max(0.0, covariance(at, at))) / unit);
    if (at >= 0 && parameters[p].key == "axis" && result.back().value.size() == 3) {
      make_direction(result.back(), covariance.block<3, 3>(at - 2, at - 2));
    }
  }
  return result;
}

std::vector<FoundEffect> found_effects(const inference::Decision& decision,
                                       const std::vector<Trial>& trials, const Candidates& all) {
  const Trial& chosen = trials[decision.chosen];
  std::vector<FoundEffect> effects;
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    const Candidate& c = all[chosen.candidates[i]];
    if (c.is_empirical) continue;
    FoundEffect effect;
    effect.kind = c.effect.kind;
    effect.explanation = explanation_of(c, chosen, chosen.disturbances[i]);
    effect.parameters = fitted_parameters(chosen, chosen.disturbances[i]);
    keep_within_bounds(c, effect.parameters);
    effect.known_together = combinations(chosen, chosen.disturbances[i]);
    effect.initial_states = initial_states(chosen, chosen.disturbances[i]);
    for (const EffectKey& key : c.effect.keys) {
      if (key.is_fixed) effect.parameters.insert(effect.parameters.begin(), {key.key, key.start});
    }
    effect.indistinguishable_from = rivals(effect.kind, chosen, trials, all);
    std::vector<std::string> group = effect.indistinguishable_from;
    group.push_back(effect.kind);
    for (size_t t = 0; t < trials.size(); ++t) {
      const std::vector<std::string> kinds = kinds_of(trials[t], all);
      if (std::ranges::find_first_of(kinds, group) != kinds.end()) {
        effect.probability += decision.probability[t];
      }
    }
    effect.probability = std::min(1.0, effect.probability);
    effects.push_back(std::move(effect));
  }
  return effects;
}

void add_effects_beside_law(const inference::Decision& decision, const std::vector<Trial>& trials,
                            const Candidates& all, Diagnosis& d) {
  const Candidates::Terms terms = all.terms_of(trials[decision.chosen]);
  // A strength of zero has no effect, and not every kind accepts it in an experiment file.
  const auto is_nothing = [&](const inference::Term<Start>& term) {
    const Candidate& c = all[term.candidate];
    bool has_strength = false;
    for (size_t p = 0; p < c.scale.size(); ++p) {
      if (!c.is_strength(p)) continue;
      if (term.start.disturbance.parameters[p].value != 0.0) return false;
      has_strength = true;
    }
    return has_strength;
  };
  for (FoundEffect& effect : found_effects(decision, trials, all)) {
    const auto is_kind = [&](size_t c) { return all[c].effect.kind == effect.kind; };
    if (std::ranges::any_of(decision.beside_law, is_kind)) {
      d.effects.push_back(std::move(effect));
    } else if (std::ranges::none_of(terms, [&](const inference::Term<Start>& term) {
                 return is_kind(term.candidate) && is_nothing(term);
               })) {
      d.unnamed.push_back(std::move(effect));
    }
  }
}

std::vector<Alternative> alternatives(const inference::Decision& decision,
                                      const std::vector<Trial>& trials, const Candidates& all) {
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
    // Empty label: the kinds alone describe the trial completely.
    if (a.kinds.size() != t->candidates.size()) a.label = label;
    a.holdout_chi2_per_sample = t->holdout_chi2_per_sample;
    a.log_evidence_relative = t->log_evidence - trials.front().log_evidence;
    a.remark = t->objection;
    a.chosen = label == label_of(trials[decision.chosen], all);
    result.push_back(std::move(a));
  }
  std::ranges::stable_sort(result, std::greater(), &Alternative::log_evidence_relative);
  if (result.size() > most) result.resize(most);
  return result;
}

std::vector<FittedParameter> refined_priors(const Trial& chosen) {
  std::vector<FittedParameter> result;
  const size_t nominal =
      chosen.disturbances.empty()
          ? chosen.fit.best.model.disturbances.size()
          : *std::min_element(chosen.disturbances.begin(), chosen.disturbances.end());
  for (size_t d = 0; d < nominal; ++d) {
    for (FittedParameter& p : fitted_parameters(chosen, d)) {
      keep_within_range(chosen.fit.best.model.disturbances[d].kind, p);
      p.key = "disturbance[" + std::to_string(d) + "]." + p.key;
      result.push_back(std::move(p));
    }
  }
  return result;
}

FoundEffect as_fitted(const Trial& chosen, size_t disturbance) {
  const Disturbance& d = chosen.fit.best.model.disturbances[disturbance];
  FoundEffect effect;
  effect.kind = d.kind;
  // All parameters, including fixed ones.
  for (const Parameter& p : d.parameters) {
    const double unit = unit_of_key(p.key).to_SI;
    if (effect.parameters.empty() || effect.parameters.back().key != p.key) {
      effect.parameters.push_back({p.key, {}, {}});
    }
    effect.parameters.back().value.push_back(p.value / unit);
    effect.parameters.back().sigma.push_back(0.0);
  }
  return effect;
}

std::vector<std::string> contradicted_priors(const Trial& chosen,
                                             const Thresholds::Decision& limits) {
  std::vector<std::string> sentences;
  for (const SharedParameter& s : chosen.fit.best.shared()) {
    const auto at = static_cast<size_t>(s.at);
    if (at == chosen.fit.parameters.shared.size()) break;  // not fitted yet
    const inference::Parameter& p = chosen.fit.parameters.shared[at];
    const auto& found = chosen.disturbances;
    const bool is_found = std::find(found.begin(), found.end(), s.disturbance) != found.end();
    const double off = (p.value - p.mean) / p.sigma;
    if (is_found || !p.has_prior() || !(std::abs(off) > limits.doubtful_prior_sigma)) continue;
    const bool is_contradicted = std::abs(off) > limits.contradicted_prior_sigma;
    sentences.push_back(printed(
        "%s: stated %.4g ± %.2g, fitted %.4g: the nominal value is %s by %.1f σ", p.name.c_str(),
        p.mean, p.sigma, p.value, is_contradicted ? "contradicted" : "doubtful", std::abs(off)));
  }
  return sentences;
}

std::string sentence_of(const Diagnosis& d) {
  // Limits for the held-out χ²: ratio before/after worth stating; excess per sample of a residual.
  constexpr double worth_saying = 1.5, leaves_something = 0.2;
  if (d.verdict == Verdict::consistent) {
    return "Nothing is missing: the differences are noise or lie within the stated uncertainty.";
  }
  if (d.verdict == Verdict::missing_physics) {
    return (d.effects.size() == 1 ? "Missing: " : "Missing together: ") + names_of(d) + ".";
  }
  if (!d.effects.empty() && d.empirical.empty()) return mostly_explained(d);
  std::string text =
      d.effects.empty()
          ? "Not explained: no effect of the catalogue explains the recording"
          : "Acts: " + names_of(d) + ", and a part that no effect of the catalogue explains";
  if (!d.where.depends_on.empty()) {
    text += "; it depends on " + d.where.depends_on.front().variable;
  }
  if (!d.because.empty()) text += " (" + d.because + ")";
  if (!d.holdout || d.alternatives.empty()) return text + ".";
  const double before = d.holdout->chi2_per_sample_before, after = d.holdout->chi2_per_sample_after;
  const auto chosen = std::find_if(d.alternatives.begin(), d.alternatives.end(),
                                   [](const Alternative& a) { return a.chosen; });
  if (chosen == d.alternatives.end() || !(before > worth_saying * after)) return text + ".";
  const std::string names = chosen->label.empty() ? joined_text(chosen->kinds, " and ", in_words)
                                                  : in_words(chosen->label);
  if (names.empty()) return text + ".";
  return text + ". Held out, " + names + " lowers χ² by a factor of " +
         printed("%.3g", before / after) +
         (after > 1.0 + leaves_something ? ", and leaves residuals above the noise." : ".");
}

}  // namespace photorque
