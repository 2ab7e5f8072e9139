// How far an unknown small torque can turn the body.
#pragma once

#include "attitude/propagation/propagator.h"

namespace photorque {

// Bound of the attitude's error [rad] at `end_s` when a torque of at most `torque_N_m` in any
// direction, changing with time as it likes, acts besides what `dynamics` knows: ∫
// |∂attitude(end)/∂rate(s) I⁻¹| ds times the torque, by the exact derivatives along the trajectory,
// at `intervals` even steps. To first order in the torque. Nothing that happens at the bearing's
// stop is known to it. NaN where the derivatives say nothing.
double attitude_error_bound_rad(const Dynamics& dynamics, const PlatformState& initial,
                                double end_s, double torque_N_m,
                                const PropagationOptions& options = {}, size_t intervals = 400);

}  // namespace photorque
