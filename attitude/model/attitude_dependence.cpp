#include <cmath>

#include "attitude/model/dynamics.h"

namespace photorque {

bool depends_on_attitude(const AttitudeModel& model) {
  const Dynamics dynamics(model);
  const bool about_axis = model.platform.turns_about_one_axis();
  // Some attitudes that no symmetry joins, and rates to go with them.
  std::vector<Lanes> y(static_cast<size_t>(dynamics.size()), Lanes(0.0));
  std::vector<Lanes> turned = y;
  for (int lane = 0; lane < Lanes::count; ++lane) {
    const double n = lane + 1.0;
    const Vec3 axis = about_axis ? model.platform.axis
                                 : Vec3(std::sin(n), std::cos(1.7 * n), std::sin(2.3 * n + 0.4));
    const std::vector<double> state = to_vector(dynamics.initial_state(0.3 * n * axis));
    for (size_t c = component::rate; c < y.size(); ++c) y[c].set(lane, state[c]);
    const Vec3 other = about_axis ? axis : Vec3(std::cos(n), 0.3, std::sin(3.1 * n));
    const Quat q(Eigen::AngleAxisd(0.7 * n, axis.normalized()));
    const Quat r = q * Quat(Eigen::AngleAxisd(1.1, other.normalized()));
    const double from[] = {q.w(), q.x(), q.y(), q.z()}, to[] = {r.w(), r.x(), r.y(), r.z()};
    for (size_t c = 0; c < 4; ++c) y[c].set(lane, from[c]);
    for (size_t c = 0; c < y.size(); ++c) turned[c].set(lane, c < 4 ? to[c] : y[c][lane]);
  }
  std::vector<Lanes> here(y.size(), Lanes(0.0)), there = here;
  const ZeroOrderHold held =
      model.schedule.held.empty() ? ZeroOrderHold{} : model.schedule.held.back();
  dynamics.rates(Lanes(0.0), held, y.data(), here.data());
  dynamics.rates(Lanes(0.0), held, turned.data(), there.data());
  for (size_t c = component::rate; c < y.size(); ++c) {
    for (int lane = 0; lane < Lanes::count; ++lane) {
      const double a = here[c][lane], b = there[c][lane];
      if (std::abs(a - b) > 1e-9 * (std::abs(a) + std::abs(b))) return true;
    }
  }
  return false;
}

}  // namespace photorque
