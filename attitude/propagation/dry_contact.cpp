#include "attitude/propagation/dry_contact.h"

#include <algorithm>
#include <cmath>

namespace photorque {

DryContact::DryContact(const Dynamics& dynamics) : dynamics_(dynamics) {
  const AttitudeModel& model = dynamics.model();
  exists_ = model.platform.turns_about_one_axis() &&
            std::any_of(model.disturbances.begin(), model.disturbances.end(),
                        [](const Disturbance& d) { return d.is_dry_friction; });
  for (size_t k = 0; k < 3; ++k) {
    if (model.platform.axis[static_cast<Eigen::Index>(k)] != 0.0) component_ = component::rate + k;
  }
}

std::vector<double> DryContact::rates(double time_s, const ZeroOrderHold& held,
                                      std::span<const double> y) const {
  const std::vector<Lanes> lanes(y.begin(), y.end());
  std::vector<Lanes> rates(y.size());
  dynamics_.rates(std::nextafter(time_s, -1e300), held, lanes.data(), rates.data());
  return lane_of(rates, 0);
}

DryContact::Accelerations DryContact::accelerations(const Lanes& time_s, ZeroOrderHold held,
                                                    const Lanes* y) const {
  std::vector<Lanes> rates(static_cast<size_t>(dynamics_.size()));
  const auto slipping = [&](Slip slip) {
    held.slip = slip;
    dynamics_.rates(time_s, held, y, rates.data());
    return rates[component_];
  };
  const Lanes forward = slipping(Slip::forward);
  return {forward, slipping(Slip::backward)};
}

Slip DryContact::at_rest(double time_s, const ZeroOrderHold& held,
                         std::span<const double> y) const {
  const std::vector<Lanes> lanes(y.begin(), y.end());
  const Accelerations f = accelerations(time_s, held, lanes.data());
  const double margin = f.margin()[0];
  if (f.forward[0] > margin) return Slip::forward;
  if (f.backward[0] < -margin) return Slip::backward;
  return margin > 0.0 ? Slip::sticks : Slip::forward;
}

Slip DryContact::released(double time_s, const ZeroOrderHold& held,
                          std::span<const double> y) const {
  const std::vector<Lanes> lanes(y.begin(), y.end());
  const Accelerations f = accelerations(time_s, held, lanes.data());
  return f.forward[0] > -f.backward[0] ? Slip::forward : Slip::backward;
}

Lanes DryContact::beyond(const Lanes& time_s, const ZeroOrderHold& held, const Lanes* y) const {
  if (held.slip == Slip::forward) return -y[component_];
  if (held.slip == Slip::backward) return y[component_];
  const Accelerations f = accelerations(time_s, held, y);
  return max(f.forward, -f.backward) - f.margin();
}

std::optional<DryContact::SlipEnd> DryContact::ends_within(const CollocationStep& step,
                                                           const ZeroOrderHold& held,
                                                           double end_s) const {
  const std::vector<double> end = step.end();
  const std::vector<Lanes> at_end(end.begin(), end.end());
  const Lanes times_s = step.stage_times_s();
  const Lanes inside = beyond(times_s, held, step.stages().data());
  double low_s = step.start_s();
  for (int i = 0; i < Lanes::count; ++i) {
    if (inside[i] > 0.0) return SlipEnd{low_s, times_s[i]};
    low_s = times_s[i];
  }
  if (beyond(end_s, held, at_end.data())[0] > 0.0) return SlipEnd{low_s, end_s};
  return std::nullopt;
}

// A step of a slipping contact is short enough if the rate has left zero at the first stage. While
// the contact sticks, the rate does not show whether the step is too long. The criterion is then
// the last Legendre term of f₊, relative to the friction.
bool DryContact::resolves(const CollocationStep& step, const ZeroOrderHold& held) const {
  if (held.slip != Slip::sticks) {
    return step.start()[component_] != 0.0 ||
           !(beyond(step.stage_times_s(), held, step.stages().data())[0] > 0.0);
  }
  constexpr double tolerance = 1e-3;
  const Accelerations f = accelerations(step.stage_times_s(), held, step.stages().data());
  const double last = sum(Lanes(gauss::projection[7]) * Lanes(gauss::weights) * f.forward) / 15.0;
  return std::abs(last) <= tolerance * largest(f.backward - f.forward);
}

}  // namespace photorque
