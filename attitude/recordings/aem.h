// CCSDS attitude ephemeris messages (AEM).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "attitude/model/platform.h"

namespace photorque {

// The attitude of the body of a message as a function of the time since its first row.
struct AemAttitude {
  double time_s;
  Quat lab_from_body;                   // lab: the frame that is not a body frame
  std::optional<Vec3> rate_body_rad_s;  // only of types with ANGVEL
  int line;                             // in the file
};
struct AttitudeEphemeris {
  std::string lab_frame;          // of the first segment, as "EME2000" or "LAB"
  std::vector<AemAttitude> rows;  // of all segments in their order
};

// Reads an attitude ephemeris message of version 1 or 2. Source: CCSDS 504.0-B-1 (2008) and
// 504.0-B-2 (2024), section 4. Version 2 has neither ATTITUDE_DIR nor QUATERNION_TYPE: the attitude
// is from A to B, with the scalar last. For types with derivatives only the attitude is read; for
// ANGVEL the rate is read too.
//
// The quaternion of an attitude from frame A to frame B is the Hamilton quaternion that rotates
// vectors of B into A. With A the lab and B the body, this is lab_from_body. Checked with two GMAT
// files that contain one attitude as quaternions and as Euler angles.
//
// InputError for a file that is no AEM, lacks a required keyword, states a name that is unknown, or
// has a row of the wrong length. InputError also for segments of several objects, an unknown type,
// an epoch that is no calendar time, a quaternion whose norm differs from one by more than 1 %, an
// angular velocity in axes other than those of A or B, and as FramePair.
AttitudeEphemeris read_aem(const std::filesystem::path& path);

// Whether a recording is an AEM. InputError for a CCSDS message of another kind.
bool is_aem(const std::filesystem::path& path);
// Whether a recording is an AEM whose attitude is relative to an inertial frame, not to a lab.
bool is_in_space(const std::filesystem::path& path);

// Writes the states of a propagated platform (at least one) as one segment of quaternions, scalar
// last. `epoch` is the calendar time of t = 0, and the date of the message, so that equal runs give
// equal files; InputError if it is no calendar time.
void write_aem(const std::filesystem::path& path, const std::vector<PlatformState>& states,
               const std::string& epoch, const std::string& object_name,
               const std::string& comment);

}  // namespace photorque
