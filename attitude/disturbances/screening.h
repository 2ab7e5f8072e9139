// Properties of a kind of disturbance as an effect that a model may lack: the priors of its
// parameters, and the method by which `diagnose` searches for it.
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
  std::vector<double> start;   // initial values of a fit, one per component
  double scale = 1.0;          // expected size: the standard deviation of the prior
  double lowest = -unbounded;  // physical bounds
  double highest = unbounded;
  bool searched = false;  // nonlinear: a fit tries several initial values
  // Start and scale are multiples of the platform's mean moment of inertia.
  bool times_inertia = false;
  bool is_fixed = false;  // selects the law; not fitted
  // Fixed at the largest value in the recordings of the channel with the key's name.
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
  // A frequency or an instant; a scan finds its initial value.
  static EffectKey shape(const std::string& key, double start, double scale, double lowest,
                         double highest = unbounded) {
    return {key, {start}, scale, lowest, highest, true};
  }
};

// One set of parameters with which an effect can be fitted. A kind may have several sets.
struct Parametrisation {
  std::string explanation;  // one sentence for the report
  std::vector<EffectKey> keys;
  bool of_free_bodies = false;  // used only for bodies without a bearing
};

// A condition under which an effect is visible.
enum class Requirement {
  none,
  command,             // commanded torques or forces
  charge,              // a battery current
  field,               // a magnetic field
  gravity,             // weight on a bearing
  bearing,             // a bearing of any kind
  air_bearing,         // a bearing that allows rotation about all axes
  laboratory,          // a bearing, or a free body in a laboratory of stated latitude
  turning_laboratory,  // an air bearing, or a free body in a laboratory of stated latitude
  wheel,               // the measured speed of a wheel
  lamps,               // the measured current of lamps, which changes during a recording
  plane,               // a planar platform: the effect is a force
  thrust,              // a planar platform with commanded forces
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
  // The channel that is needed to distinguish both kinds, for any start of a run. None: one kind
  // contains the other, and both together count as one effect.
  Requirement distinguished_by = Requirement::none;
};

// Lower limit for the sum of the parameters [SI] of all disturbances of one kind in a model: the
// nominal one and its correction, which may be negative.
struct MinimumSum {
  double lowest = 0.0;
  std::string objection;  // the message for a model below the limit
};

// The effect is a force on a platform that slides.
inline bool is_force(Requirement needs) {
  return needs == Requirement::plane || needs == Requirement::thrust;
}

struct DisturbanceContext;  // attitude/disturbances/kind.h

struct Screening {
  // The parameters that `diagnose` fits; empty: it does not test the kind, see `reason_against`.
  std::vector<Parametrisation> parametrisations = {};
  std::string reason_against = {};
  // Instead of `parametrisations`, if they depend on the experiment; empty if it has none of the
  // kind. `widths` describes their expected sizes in documents.
  std::vector<Parametrisation> (*of_experiment)(const DisturbanceContext&) = nullptr;
  std::string widths = {};
  Requirement needs = Requirement::none;
  Scan scan = Scan::nothing;
  bool fast = false;           // changes within averaged blocks: fitted to all readings
  bool per_recording = false;  // has a separate value in each recording
  bool steady = false;         // a constant torque in the lab frame
  // Change of the platform's inertia by a fitted disturbance, for the limit of plausible changes;
  // null: none.
  Mat3 (*inertia_change_kg_m2)(const Disturbance&) = nullptr;
  bool changes_mass = false;  // its first parameter is added to the platform's mass [kg]
  std::optional<MinimumSum> minimum_sum = {};
  std::vector<ConfusableKind> confusable_kinds = {};
};

// The test by `diagnose` in words, for documents: the expected sizes of the parameters [SI] and the
// requirement, or the reason why there is no test.
std::string screening_text(const Screening& screening);

}  // namespace photorque
