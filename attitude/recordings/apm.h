// CCSDS attitude parameter messages (APM): the attitude and rate of a body at one instant.
#pragma once

#include <filesystem>
#include <optional>

#include "attitude/environment/epoch.h"
#include "core/transform.h"

namespace photorque {

struct AttitudeParameters {
  Epoch epoch;         // UTC
  Quat lab_from_body;  // lab: the frame that is no body's
  std::optional<Vec3> rate_body_rad_s;
};

// Reads an APM of version 1 or 2, KVN or XML. The attitude is the first quaternion with usable
// frames or, if there is none, the first such Euler angles. The rate is the angular velocity, the
// derivative of the quaternion or the rates of the Euler angles. Inertia and manoeuvres are not
// used. InputError for a file that is no APM, for rotating or unknown frames, for unknown time
// systems, and for spin parameters alone. InputError also for rates of Euler angles in version 1,
// whose frame the book does not state. Sources: CCSDS 504.0-B-1 (2008) and 504.0-B-2 (2024),
// section 3.
AttitudeParameters read_apm(const std::filesystem::path& path);

}  // namespace photorque
