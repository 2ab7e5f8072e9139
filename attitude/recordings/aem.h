// CCSDS attitude ephemeris messages (AEM). A message that is read and written again is equal in
// every digit.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/recordings/kvn.h"

namespace photorque {

// An attitude ephemeris message, version 1 or 2. Source: CCSDS 504.0-B-1 (2008) and 504.0-B-2
// (2024), section 4. Version 2 has neither ATTITUDE_DIR nor QUATERNION_TYPE: the attitude is from A
// to B, with the scalar last. For types with derivatives only the attitude is read; for ANGVEL the
// rate is read too.
//
// The quaternion of an attitude from frame A to frame B is the Hamilton quaternion that rotates
// vectors of B into A. With A the lab and B the body, this is lab_from_body. Checked with two GMAT
// files that contain one attitude as quaternions and as Euler angles.

struct AttitudeEphemeris {
  struct Row {
    std::string epoch;           // as written
    std::vector<double> values;  // in the order of the file
    int line = 0;                // in the file
  };
  struct Segment {
    std::string object_name, object_id, center_name;
    std::string ref_frame_a, ref_frame_b;
    std::string attitude_dir = "A2B";  // or B2A
    std::string time_system = "UTC";
    std::string start_time, stop_time;
    std::string useable_start_time, useable_stop_time;  // empty: not given
    std::string attitude_type = "QUATERNION";           // or another type of the books
    std::string quaternion_type;                        // FIRST or LAST: position of the scalar
    std::string euler_rot_seq;                          // "321" or "ZYX": axes in order of rotation
    std::string rate_frame, angvel_frame;               // of rates: version 1, version 2
    std::string interpolation_method, interpolation_degree;
    std::vector<std::string> comments;
    int line = 0;  // of the metadata in the file
    std::vector<Row> rows;

    struct Sample {
      double time_s;  // since the first row
      Quat a_from_b;  // unit
      // Rate of B with respect to A, in axes of B; only with ANGVEL.
      std::optional<Vec3> rate_rad_s = {};
    };
    // The rows as attitudes. InputError, with the name of the file, for an unknown type, an epoch
    // that is no calendar time, a quaternion whose norm differs from one by more than 1 %, or an
    // angular velocity in axes other than those of A or B.
    std::vector<Sample> attitudes(const std::filesystem::path& file = {}) const;
  };
  std::string version = "1.0";
  std::string creation_date, originator;
  std::vector<std::string> comments;
  std::vector<Segment> segments;
};

// The attitude of the body of a message as a function of the time since its first row.
struct AemAttitude {
  double time_s;
  Quat lab_from_body;  // lab: the frame that is not a body frame
  std::optional<Vec3> rate_body_rad_s;
  int line;  // in the file
};
// The rows of all segments in their order. InputError as read_aem(), Segment::attitudes() and
// FramePair, and for segments of several objects.
std::vector<AemAttitude> aem_attitudes(const std::filesystem::path& path);

// Whether a recording is an AEM. InputError for a CCSDS message of another kind.
bool is_aem(const std::filesystem::path& path);
// Whether a recording is an AEM whose attitude is relative to an inertial frame, not to a lab.
bool is_in_space(const std::filesystem::path& path);

// InputError for a file that is no AEM, lacks a required keyword, states a name that is unknown, or
// has a row of the wrong length.
AttitudeEphemeris read_aem(const std::filesystem::path& path);
KvnItem to_kvn(const AttitudeEphemeris& aem);
void write_aem(const std::filesystem::path& path, const AttitudeEphemeris& aem);

// One segment of quaternions, scalar last, from a propagated platform. `epoch` is the calendar time
// of t = 0; InputError if it is no calendar time.
AttitudeEphemeris make_aem(const std::vector<PlatformState>& states, const std::string& epoch,
                           const std::string& object_name, const std::string& creation_date);

}  // namespace photorque
