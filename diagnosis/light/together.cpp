#include "diagnosis/light/together.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "attitude/disturbances/kind.h"
#include "core/constants.h"
#include "diagnosis/light/nominal_light.h"

namespace photorque {
namespace {

// Tilt of the camera as an effect on the motion. Its rotation vector takes the lab's −z to gravity,
// so it is opposite to that of the body.
constexpr const char* of_motion = "gravity_tilt";
constexpr const char* tilt_key = "tilt_rad";
// The tilt as an effect on the light.
constexpr const char* of_light = "attitude_bias";

// Prior width of an unknown tilt; error below which it counts as known.
constexpr double any_tilt_rad = 0.1, known_tilt_rad = 0.01;
constexpr double beyond_doubt_sigma = 5.0;

Diagnosis diagnose_light_with_prior(const LightRecorded& light, const Tilt& tilt) {
  NominalLight nominal = light.nominal;
  add_tilt_prior(light.lab, tilt.bias_rad, tilt.sigma_rad, nominal);
  return diagnose_light(light.lab, nominal, light.recordings, light.holdouts, light.how);
}

// The tilt determined by the light.
std::optional<Tilt> tilt_of_light(const Diagnosis& light) {
  for (const FittedParameter& p : light.priors_refined) {
    if (p.key != tilt_prior) continue;
    return Tilt{Vec2(p.value[0], p.value[1]) * degree_rad,
                Vec2(p.sigma[0], p.sigma[1]) * degree_rad};
  }
  return std::nullopt;
}

// The tilt determined by the motion: a refined prior or a found effect.
std::optional<Tilt> tilt_of_motion(const Diagnosis& motion) {
  // `tilt_key`, or the key of a prior that ends in it.
  const auto tilt_in = [](const std::vector<FittedParameter>& all) -> std::optional<Tilt> {
    for (const FittedParameter& p : all) {
      const bool is_tilt = p.key == tilt_key || p.key.ends_with(std::string("].") + tilt_key);
      if (!is_tilt || p.value.size() != 2 || p.sigma.size() != 2) continue;
      if (!(p.sigma[0] > 0.0 && p.sigma[1] > 0.0)) continue;
      return Tilt{-Vec2(p.value[0], p.value[1]), Vec2(p.sigma[0], p.sigma[1])};
    }
    return std::nullopt;
  };
  if (motion.verdict == Verdict::unexplained) return std::nullopt;
  for (const FoundEffect& effect : motion.effects) {
    if (effect.kind != of_motion) continue;
    return tilt_in(effect.parameters);
  }
  return tilt_in(motion.priors_refined);
}

bool names_tilt(const Diagnosis& motion) {
  return std::ranges::find(motion.effects, of_motion, &FoundEffect::kind) != motion.effects.end();
}

// The tilt determined by the motion alone: the information of the light is subtracted from `both`,
// the result of motion and light. Returns nothing if `both` is hardly more precise than the light.
std::optional<Tilt> beside(const Tilt& both, const Tilt& light) {
  constexpr double better = 0.7;
  if (!(both.sigma_rad.array() < better * light.sigma_rad.array()).any()) return std::nullopt;
  Tilt alone{both.bias_rad, Vec2::Constant(any_tilt_rad)};
  for (int k = 0; k < 2; ++k) {
    const double weight = std::pow(both.sigma_rad[k], -2.0) - std::pow(light.sigma_rad[k], -2.0);
    if (!(weight > std::pow(any_tilt_rad, -2.0))) continue;
    alone.sigma_rad[k] = 1.0 / std::sqrt(weight);
    alone.bias_rad[k] = (both.bias_rad[k] * std::pow(both.sigma_rad[k], -2.0) -
                         light.bias_rad[k] * std::pow(light.sigma_rad[k], -2.0)) /
                        weight;
  }
  return alone;
}

// The light is a linear function of small tilts only, so a larger tilt is fitted again about its
// estimate.
Diagnosis light_with_any_tilt(const LightRecorded& light) {
  constexpr double small_rad = 0.004;
  Tilt any{Vec2::Zero(), Vec2::Constant(any_tilt_rad)};
  Diagnosis d = diagnose_light_with_prior(light, any);
  for (int round = 0; round < 2; ++round) {
    const std::optional<Tilt> seen = tilt_of_light(d);
    if (!seen || !((seen->bias_rad - any.bias_rad).norm() > small_rad)) break;
    if (!(seen->bias_rad.norm() < 3.0 * any_tilt_rad)) break;
    any.bias_rad = seen->bias_rad;
    d = diagnose_light_with_prior(light, any);
  }
  return d;
}

Disturbance tilt_prior_disturbance(const NominalModel& nominal, const Tilt& tilt) {
  Disturbance d = make_disturbance_of(
      of_motion, {{tilt_key, {-tilt.bias_rad.x(), -tilt.bias_rad.y()}}}, nominal.context());
  for (size_t k = 0; k < d.parameters.size(); ++k) {
    d.parameters[k].sigma = tilt.sigma_rad[static_cast<Eigen::Index>(k)];
  }
  return d;
}

// Adds the tilt to the effects of both domains if it is significant.
void add_tilt(const std::optional<Tilt>& tilt, Diagnosis& motion, Diagnosis& light) {
  // Experiments do not state a prior on the tilt.
  const auto is_tilt = [](const FittedParameter& p) {
    return p.key == tilt_prior || p.key.ends_with(std::string("].") + tilt_key);
  };
  std::erase_if(light.priors_refined, is_tilt);
  if (!tilt) return;
  const double sigma = tilt->bias_rad.cwiseQuotient(tilt->sigma_rad).norm();
  std::erase_if(motion.priors_refined, is_tilt);
  if (!(sigma > beyond_doubt_sigma)) return;
  const auto numbers = [](const Vec2& v) { return std::vector<double>{v.x(), v.y()}; };
  FoundEffect effect;
  effect.probability = 1.0;
  if (!names_tilt(motion)) {
    effect.kind = of_motion;
    effect.explanation = "the camera is not level, according to motion and light";
    effect.parameters = {{tilt_key, numbers(-tilt->bias_rad), numbers(tilt->sigma_rad)}};
    motion.effects.push_back(effect);
  }
  effect.kind = of_light;
  effect.explanation = "the platform is rotated relative to its recorded attitude";
  effect.parameters = {
      {"bias_deg", numbers(tilt->bias_rad / degree_rad), numbers(tilt->sigma_rad / degree_rad)}};
  light.effects.push_back(effect);
}

// Noise-free attitudes that the camera would have measured according to the found model.
std::map<double, Quat> attitudes_of(const Diagnosis& motion, const std::string& recording) {
  std::map<double, Quat> at;
  for (const RecordingSeries& series : motion.series) {
    if (series.recording != recording) continue;
    const AttitudeSeries& seen = series.attitude;
    for (size_t i = 0; i < seen.time_s.size(); ++i) {
      const Vec3& off = seen.off_after_rad[i];
      if (!off.allFinite()) continue;
      at[seen.time_s[i]] = (turn_by(-off) * seen.measured[i]).normalized();
    }
  }
  return at;
}

// Cubic interpolation with slopes from the neighbouring points. Returns nothing outside the
// recorded time or in a gap.
std::optional<Quat> between(const std::map<double, Quat>& all, double time_s, double max_gap_s) {
  const auto exact = all.find(time_s);
  if (exact != all.end()) return exact->second;
  const auto next = all.upper_bound(time_s);
  if (next == all.begin() || next == all.end()) return std::nullopt;
  const auto last = std::prev(next);
  const double h = next->first - last->first;
  if (h > max_gap_s) return std::nullopt;
  const auto turn = [](const Quat& from, const Quat& to) {
    return turn_vector(from.conjugate() * to);
  };
  const Vec3 step = turn(last->second, next->second);
  const auto before = last == all.begin() ? last : std::prev(last);
  const auto after = std::next(next) == all.end() ? next : std::next(next);
  const Vec3 slope_last = turn(before->second, next->second) / (next->first - before->first),
             slope_next = turn(last->second, after->second) / (after->first - last->first);
  const double t = (time_s - last->first) / h, u = 1.0 - t;
  const Vec3 by = t * t * (3.0 - 2.0 * t) * step + h * t * u * (u * slope_last - t * slope_next);
  return last->second * turn_by(by);
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

void take_attitudes(const Diagnosis& motion, std::vector<LightRecording>& runs) {
  if (motion.verdict == Verdict::unexplained) return;
  for (LightRecording& run : runs) {
    if (run.kind != LightRecording::Kind::run || run.time_s.empty()) continue;
    const std::map<double, Quat> all = attitudes_of(motion, run.name);
    if (all.size() < 2) continue;
    const double max_gap_s =
        5.0 * (all.rbegin()->first - all.begin()->first) / static_cast<double>(all.size() - 1);
    for (size_t i = 0; i < run.rows(); ++i) {
      if (const auto q = between(all, run.time_s[i], max_gap_s)) run.lab_from_body[i] = *q;
    }
  }
}

Diagnosis diagnose_together(MotionRecorded motion, LightRecorded light) {
  const auto moved = [&] {
    return diagnose(motion.nominal, motion.recordings, motion.holdouts, motion.how);
  };
  const Diagnosis of_motion_first = moved();
  take_attitudes(of_motion_first, light.recordings);
  take_attitudes(of_motion_first, light.holdouts);
  // If a tilt is stated, it is not fitted.
  const auto is_tilt = [](const Disturbance& d) { return d.kind == of_motion; };
  if (std::ranges::any_of(motion.nominal.model.disturbances, is_tilt)) {
    return joined(
        of_motion_first,
        diagnose_light(light.lab, light.nominal, light.recordings, light.holdouts, light.how),
        std::nullopt);
  }
  Diagnosis of_light_alone = light_with_any_tilt(light);
  std::optional<Tilt> seen = tilt_of_light(of_light_alone);
  const bool measures_tilt = seen && seen->sigma_rad.maxCoeff() < known_tilt_rad;
  if (of_light_alone.verdict == Verdict::unexplained || !measures_tilt) seen.reset();
  if (seen)
    motion.nominal.model.disturbances.push_back(tilt_prior_disturbance(motion.nominal, *seen));
  const Diagnosis of_both = seen ? moved() : of_motion_first;
  // If the motion names a tilt in addition to the prior from the light, the two disagree.
  const bool disagree = seen && names_tilt(of_both);
  std::optional<Tilt> tilt = disagree ? seen : tilt_of_motion(of_both);
  if (!tilt) tilt = seen;
  std::optional<Tilt> of_motion_alone = tilt;
  if (tilt && seen) of_motion_alone = beside(*tilt, *seen);
  return joined(
      of_both,
      of_motion_alone ? diagnose_light_with_prior(light, *of_motion_alone) : of_light_alone, tilt);
}

Diagnosis joined(const Diagnosis& motion, const Diagnosis& light, const std::optional<Tilt>& tilt) {
  Diagnosis d = motion, with_light = light;
  add_tilt(tilt, d, with_light);
  const bool is_tilted = with_light.effects.size() > light.effects.size();
  d.domains = {{"motion", motion.verdict, motion.confidence, motion.sentence},
               {"light", light.verdict, light.confidence, light.sentence}};
  for (FoundEffect& effect : d.effects) effect.table = motion.effect_table;
  for (FoundEffect& effect : with_light.effects) effect.table = light.effect_table;
  append(d.effects, with_light.effects);
  const bool is_unexplained =
      motion.verdict == Verdict::unexplained || light.verdict == Verdict::unexplained;
  d.verdict = is_unexplained      ? Verdict::unexplained
              : d.effects.empty() ? Verdict::consistent
                                  : Verdict::missing_physics;
  d.confidence = motion.confidence * light.confidence;
  d.sentence = (is_tilted ? "The platform is rotated relative to its recorded attitude. Motion: "
                          : "Motion: ") +
               in_words(name_of(motion.verdict)) + ". " + motion.sentence +
               " Light: " + in_words(name_of(light.verdict)) + ". " + light.sentence;
  if (d.because.empty()) d.because = light.because;
  append(d.where.channels, light.where.channels);
  std::ranges::stable_sort(d.where.channels, std::greater(),
                           &Where::ChannelMisfit::chi2_per_sample);
  append(d.where.depends_on, light.where.depends_on);
  d.chi2_per_sample_before = weighted_mean(motion.chi2_per_sample_before, motion.samples,
                                           light.chi2_per_sample_before, light.samples);
  d.chi2_per_sample_after = weighted_mean(motion.chi2_per_sample_after, motion.samples,
                                          light.chi2_per_sample_after, light.samples);
  d.samples = motion.samples + light.samples;
  if (motion.holdout && light.holdout) {
    d.holdout->rms_before.insert(light.holdout->rms_before.begin(),
                                 light.holdout->rms_before.end());
    d.holdout->rms_after.insert(light.holdout->rms_after.begin(), light.holdout->rms_after.end());
    d.holdout->explained_fraction =
        std::min(d.holdout->explained_fraction, light.holdout->explained_fraction);
    add_held_out(*light.holdout, *d.holdout);
  } else if (light.holdout) {
    d.holdout = light.holdout;
  }
  for (Alternative& a : d.alternatives) a.of = "motion";
  append(d.alternatives, light.alternatives);
  for (Alternative& a : d.alternatives) {
    if (a.of.empty()) a.of = "light";
  }
  append(d.manoeuvres, light.manoeuvres);
  append(d.priors_refined, with_light.priors_refined);
  append(d.warnings, light.warnings);
  append(d.series, light.series);
  d.array = light.array;
  d.data.rows += light.data.rows;
  d.data.used += light.data.used;
  for (const auto& [reason, count] : light.data.rejected) d.data.rejected[reason] += count;
  return d;
}

}  // namespace photorque
