#include "attitude/estimation/nominal_model.h"

#include "attitude/disturbances/kind.h"

namespace photorque {

Hypothesis nominal_hypothesis(const NominalModel& nominal, const std::vector<Observation>& runs) {
  Hypothesis h;
  h.model = nominal.model;
  std::vector<double> own;
  for (size_t d = 0; d < h.model.disturbances.size(); ++d) {
    const Disturbance& disturbance = h.model.disturbances[d];
    const DisturbanceKind* kind = find_kind(disturbance.kind);
    const bool per_run = kind != nullptr && kind->screening.per_recording;
    for (size_t p = 0; p < disturbance.parameters.size(); ++p) {
      const Parameter& parameter = disturbance.parameters[p];
      if (!(parameter.sigma > 0.0)) continue;
      h.free.push_back({d, static_cast<int>(p), parameter.value, parameter.sigma, per_run});
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
                                  state.per_body_rate.dot(run.initial.rate_body_rad_s));
    }
  }
  return hypothesis.model.disturbances.size() - 1;
}

Fit fit_nominal(const NominalModel& nominal, const std::vector<Observation>& runs,
                const Thresholds& limits) {
  FitSettings settings;
  settings.windows = limits.fitting.first_windows;
  return fit(nominal_hypothesis(nominal, runs), runs, settings);
}

}  // namespace photorque
