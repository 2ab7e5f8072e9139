// The keys of a camera that sees markers, and [camera_study], as they are declared.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// read_tracking_camera().
std::vector<Key> tracking_camera_keys();
Key camera_study_table();

}  // namespace photorque
