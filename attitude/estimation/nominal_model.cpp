#include "attitude/estimation/nominal_model.h"

#include "attitude/disturbances/kind.h"
#include "attitude/estimation/starts.h"
#include "attitude/model/disturbance.h"

namespace photorque {
namespace {

// The least that physics allows of a key, as the kind's own file says.
double lowest_of(const DisturbanceKind* kind, const std::string& key) {
  if (kind == nullptr) return -inference::infinity;
  if (kind->screening.least_sum) return kind->screening.least_sum->lowest;
  for (const Parametrisation& p : kind->screening.parametrisations) {
    for (const EffectKey& k : p.keys) {
      if (k.key == key && k.lowest > -EffectKey::unbounded) return k.lowest;
    }
  }
  return -inference::infinity;
}

}  // namespace

Hypothesis nominal_hypothesis(const NominalModel& nominal, const std::vector<Observation>& runs) {
  Hypothesis h;
  h.model = nominal.model;
  std::vector<double> own;
  for (size_t d = 0; d < h.model.disturbances.size(); ++d) {
    const Disturbance& disturbance = h.model.disturbances[d];
    const DisturbanceKind* kind = find_kind(disturbance.kind);
    const bool per_run = disturbance.per_recording;
    for (size_t p = 0; p < disturbance.parameters.size(); ++p) {
      const Parameter& parameter = disturbance.parameters[p];
      if (!(parameter.sigma > 0.0)) continue;
      Free f{d, static_cast<int>(p), parameter.value, parameter.sigma, per_run};
      f.per_recording = per_run;
      // What physics forbids of an effect it forbids of a belief, wherever it starts.
      if (parameter.value >= lowest_of(kind, parameter.key)) {
        f.lowest = lowest_of(kind, parameter.key);
      }
      h.free.push_back(f);
      if (per_run) own.push_back(parameter.value);
    }
  }
  for (const Observation& seen : runs) h.runs.push_back({first_state(h.model, seen), own});
  return h;
}

size_t add_disturbance(Hypothesis& hypothesis, const Disturbance& disturbance) {
  hypothesis.model.disturbances.push_back(disturbance);
  for (RunStart& run : hypothesis.runs) {
    for (const ExtraState& state : disturbance.states) {
      run.initial.extra.push_back(state.initial +
                                  bound_axis(disturbance, state).dot(run.initial.rate_body_rad_s));
    }
  }
  return hypothesis.model.disturbances.size() - 1;
}

Fit fit_nominal(const NominalModel& nominal, const std::vector<Observation>& runs,
                const Thresholds& limits) {
  FitSettings settings;
  settings.windows = limits.fitting.first_windows;
  Hypothesis start = nominal_hypothesis(nominal, runs);
  choose_starts(start, runs);
  return fit(start, runs, settings);
}

}  // namespace photorque
