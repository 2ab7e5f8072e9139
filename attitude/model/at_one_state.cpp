// What every disturbance does at one state, and the disturbance that carries what slides.
#include "attitude/model/dynamics.h"

namespace photorque {
namespace {

Dynamics::Instants instants_at(const AttitudeModel& model, const PlatformState& state) {
  const Dynamics dynamics(model);
  std::vector<Lanes> y;
  for (const double x : to_vector(state)) y.emplace_back(x);
  std::array<ZeroOrderHold, Lanes::count> held;
  held.fill(model.schedule.at(state.time_s));
  return dynamics.at(state.time_s, held, y.data());
}

std::vector<Vec3> vectors_of_first_lane(const std::vector<Vec3Of<Lanes>>& all) {
  std::vector<Vec3> vectors;
  for (const Vec3Of<Lanes>& v : all) vectors.emplace_back(v[0][0], v[1][0], v[2][0]);
  return vectors;
}

}  // namespace

std::vector<Vec3> disturbance_torques_body_N_m(const AttitudeModel& model,
                                               const PlatformState& state) {
  return vectors_of_first_lane(instants_at(model, state).torque_body_N_m);
}

std::vector<Vec3> disturbance_forces_lab_N(const AttitudeModel& model, const PlatformState& state) {
  return vectors_of_first_lane(instants_at(model, state).force_lab_N);
}

namespace {

struct NoLaw final : LawOf<NoLaw> {
  template <class T>
  void apply(const ParametersAndStates<T>&, EvaluationContext<T>&) const {}
};

}  // namespace

Disturbance translation() {
  // Deviations of a decimetre matter as much as those of a radian.
  constexpr double scale = 0.1;
  const auto state = [](const char* name) { return ExtraState{name, 0.0, scale}; };
  Disturbance d = make_disturbance<NoLaw>({}, Stage::torque,
                                          {state("position_x_m"), state("position_y_m"),
                                           state("velocity_x_m_s"), state("velocity_y_m_s")});
  d.kind = translation_kind;
  return d;
}

}  // namespace photorque
