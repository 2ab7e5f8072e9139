// Where a platform that slides is.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "attitude/model/dynamics.h"
#include "core/settings/settings.h"

namespace photorque {

// Reads initial_position_m[2] and initial_velocity_m_s[2] of [propagate], both zero by default;
// nothing of a platform that does not slide.
void read_initial_place(const Settings& settings, const AttitudeModel& model,
                        PlatformState& initial);

// Place (x, y) and velocity in a state vector; none where the platform does not slide.
std::optional<std::array<double, 4>> place_of(const Dynamics& dynamics,
                                              const std::vector<double>& y);

}  // namespace photorque
