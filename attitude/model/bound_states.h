// How states that count from the inertial frame begin where the platform begins by turning as one
// rigid body.
#pragma once

#include "attitude/model/disturbance.h"

namespace photorque {

// What such a state takes of the rate, body axes: the direction of the disturbance's own `axis`, as
// that stands now, where it has one; otherwise ExtraState::per_body_rate. Zero: it takes nothing.
Vec3 bound_axis(const Disturbance& disturbance, const ExtraState& state);

// ∂(bound_axis · rate) by a parameter of the disturbance [(rad/s) per the parameter's SI unit].
double bound_rate_slope(const Disturbance& disturbance, const ExtraState& state, int parameter,
                        const Vec3& rate_body_rad_s);

}  // namespace photorque
