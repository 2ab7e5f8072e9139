// CCSDS attitude comprehensive messages (ACM), version 2, keyword-value notation.
//
// The message is kept whole, block by block; attitudes and physical properties are also read into
// numbers. Source: CCSDS 504.0-B-2 (2024), section 5.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "attitude/ccsds/kvn.h"
#include "core/transform.h"

namespace photorque {

struct AttitudeComprehensive {
  KvnItem message;  // everything, as written

  // One ATT block. Times are seconds after EPOCH_TZERO, values in the order of the file: attitude
  // (scalar of a quaternion last; angles in deg) and then rates.
  struct AttitudeBlock {
    std::string frame_a, frame_b, type, rate_type, euler_sequence;
    std::vector<double> time_s;
    std::vector<std::vector<double>> values;
    // Quaternion rows as a_from_b, normalised. InputError for other types.
    std::vector<Quat> quaternions() const;
  };
  std::vector<AttitudeBlock> attitudes;

  // The PHYS block.
  std::optional<double> wet_mass_kg;
  std::optional<Mat3> inertia_kg_m2;
  std::string epoch_of_zero;
};

// InputError for files that are no ACM, for rows whose length is not NUMBER_STATES, and for units
// other than the book's.
AttitudeComprehensive read_acm(const std::filesystem::path& path);
void write_acm(const std::filesystem::path& path, const AttitudeComprehensive& acm);

}  // namespace photorque
