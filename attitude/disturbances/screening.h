// Properties of a kind of disturbance as an effect that a model may lack: what a fit assumes about
// its parameters before looking, and how `diagnose` has to look for it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "attitude/model/disturbance.h"

namespace photorque {

// One key of an effect, SI.
struct EffectKey {
  static constexpr double unbounded = 1e308;

  std::string key;             // as in an experiment file
  std::vector<double> start;   // where a fit begins; its size is the number of components
  double scale = 1.0;          // size to be expected: the width of the prior
  double lowest = -unbounded;  // bounds of physics
  double highest = unbounded;
  bool searched = false;  // enters nonlinearly: several starts are tried
  // Start and scale are multiples of the platform's mean moment of inertia.
  bool times_inertia = false;
  bool is_fixed = false;  // selects the law; not fitted
  // Fixed at the largest that the recordings have of the channel of the key's name.
  bool is_largest_recorded = false;

  // A strength of either sign, one that cannot be negative, and one for each body axis.
  static EffectKey number(const std::string& key, double scale) { return {key, {0.0}, scale}; }
  static EffectKey not_negative(const std::string& key, double scale) {
    return {key, {0.0}, scale, 0.0};
  }
  static EffectKey vector(const std::string& key, double scale) {
    return {key, {0.0, 0.0, 0.0}, scale};
  }
  static EffectKey fixed_at(const std::string& key, double value) {
    EffectKey fixed{key, {value}, 0.0};
    fixed.is_fixed = true;
    return fixed;
  }
  static EffectKey largest_recorded(const std::string& key) {
    EffectKey fixed = fixed_at(key, 1.0);
    fixed.is_largest_recorded = true;
    return fixed;
  }
  static EffectKey vector_not_negative(const std::string& key, double scale) {
    return {key, {0.0, 0.0, 0.0}, scale, 0.0};
  }
  // A shape (a frequency, an instant) whose starts a scan has to find.
  static EffectKey shape(const std::string& key, double start, double scale, double lowest,
                         double highest = unbounded) {
    return {key, {start}, scale, lowest, highest, true};
  }
};

// One set of parameters with which an effect can be fitted: of one kind there may be several.
struct Parametrisation {
  std::string explanation;  // one sentence for the report
  std::vector<EffectKey> keys;
  bool of_free_bodies = false;  // only they have it: no bearing turns them, and their shape shows
};

// A condition under which an effect is visible.
enum class Requirement {
  none,
  command,             // torques commanded, or forces
  charge,              // a current
  field,               // a magnetic field
  gravity,             // weight on a support
  bearing,             // something that carries the platform
  air_bearing,         // and lets it turn about all axes
  laboratory,          // that the attitude refers to: a bearing's, or round a free body at a stated
                       // latitude
  turning_laboratory,  // the same, seen by what turns about all axes
  wheel,               // the measured speed of one
  lamps,               // the measured current of some, and not always the same
  plane,               // a platform that slides: the effect is a force
  thrust,              // the same, and forces commanded
};

// A quantity that is scanned before a fit.
enum class Scan {
  nothing,
  instant,    // key "time_s"
  frequency,  // keys "frequency_Hz" and "phase"
  mode,       // keys "frequency_Hz", "damping", "axis" and "inertia_kg_m2"
};

// Another kind whose effect has the same form.
struct ConfusableKind {
  std::string kind;
  // The channel that alone separates them, whatever the start of a run; none: one is contained in
  // the other, and both together are one effect.
  Requirement distinguished_by = Requirement::none;
};

// All disturbances of one kind in a model, the nominal one and its correction of either sign, must
// not sum to less than this: their parameters, SI.
struct LeastSum {
  double lowest = 0.0;
  std::string objection;  // printed for a model that does
};

// The effect is a force on a platform that slides.
inline bool is_force(Requirement needs) {
  return needs == Requirement::plane || needs == Requirement::thrust;
}

struct DisturbanceContext;  // attitude/disturbances/kind.h

struct Screening {
  // How `diagnose` fits the effect; none: it does not, for the reason that follows.
  std::vector<Parametrisation> parametrisations = {};
  std::string reason_against = {};
  // In place of these, where they follow from the experiment: none if it has nothing of the kind;
  // and what documents say of them.
  std::vector<Parametrisation> (*of_experiment)(const DisturbanceContext&) = nullptr;
  std::string widths = {};
  Requirement needs = Requirement::none;
  Scan scan = Scan::nothing;
  bool fast = false;           // acts within averages of the readings: fitted to all of them
  bool per_recording = false;  // has another value after every switching on
  bool steady = false;         // a torque that nothing changes, in the laboratory
  // By how much a fitted disturbance changes the platform's inertia, of which there is a limit to
  // credible value; null: not at all.
  Mat3 (*inertia_change_kg_m2)(const Disturbance&) = nullptr;
  bool changes_mass = false;  // its first parameter is added to the platform's mass [kg]
  std::optional<LeastSum> least_sum = {};
  std::vector<ConfusableKind> confusable_kinds = {};
};

}  // namespace photorque
