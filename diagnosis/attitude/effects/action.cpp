// Action of a candidate on the motion: whether it brakes, and whether it restores an angle.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"
#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

Disturbance Candidate::at_expected_size() const {
  Disturbance acting = start;
  for (size_t p = 0; p < acting.parameters.size(); ++p) {
    if (is_strength(p)) acting.parameters[p].value += scale[p];
  }
  return acting;
}

Disturbance Candidate::with_strength_alone(size_t p) const {
  Disturbance alone = start;
  for (size_t other = 0; other < alone.parameters.size(); ++other) {
    if (is_strength(other)) alone.parameters[other].value = other == p ? scale[p] : 0.0;
  }
  return alone;
}

std::optional<double> braking_power(const Candidate& candidate, AttitudeModel model) {
  const bool slides = model.platform.slides(), pushes = is_force(candidate.effect.how.needs);
  if (candidate.is_empirical || candidate.start.stage == Stage::measurement) return std::nullopt;
  if (pushes ? !slides : !model.platform.turns_about_one_axis()) return std::nullopt;
  model.disturbances = {candidate.at_expected_size()};
  if (slides) model.disturbances.push_back(translation());
  // The force along x at this speed, or the torque about the axis at this rate.
  const auto action = [&](double motion) {
    PlatformState state =
        Dynamics(model).initial_state(pushes ? Vec3::Zero().eval() : motion * model.platform.axis);
    if (slides) {
      std::copy_n(std::array{0.0, 0.0, pushes ? motion : 0.0, 0.0}.begin(), 4,
                  state.extra.end() - 4);
    }
    return pushes ? disturbance_forces_lab_N(model, state).front().x()
                  : model.platform.axis.dot(disturbance_torques_body_N_m(model, state).front());
  };
  constexpr double slow = 0.5, alike = 1e-6;
  const double forward = action(slow), backward = action(-slow), faster = action(2.0 * slow);
  const bool brakes = forward < 0.0 && std::abs(forward + backward) < -alike * forward;
  if (!brakes || !(faster < 0.0)) return std::nullopt;
  return std::log2(faster / forward);
}

bool is_restoring(const Candidate& candidate, AttitudeModel model) {
  if (candidate.is_empirical || candidate.start.stage == Stage::measurement ||
      !model.platform.turns_about_one_axis() || is_force(candidate.effect.how.needs)) {
    return false;
  }
  model.disturbances = {candidate.at_expected_size()};
  if (model.platform.slides()) model.disturbances.push_back(translation());
  const Vec3& axis = model.platform.axis;
  const auto torque = [&](double angle_rad, double rate_rad_s) {
    PlatformState state = Dynamics(model).initial_state(rate_rad_s * axis);
    state.lab_from_body = Quat(Eigen::AngleAxisd(angle_rad, axis));
    return axis.dot(disturbance_torques_body_N_m(model, state).front());
  };
  constexpr double near_rad = pi / 3.0, far_rad = 2.0 * pi / 3.0, alike = 1e-6;
  const double near = torque(near_rad, 0.0) - torque(-near_rad, 0.0),
               far = torque(far_rad, 0.0) - torque(-far_rad, 0.0),
               of_rate = torque(near_rad, 1.0) - torque(near_rad, 0.0);
  return near * far > 0.0 && std::abs(of_rate) < alike * std::abs(near);
}

}  // namespace photorque
