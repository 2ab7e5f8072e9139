// [sensors] and [recording] as they are declared; sensors.cpp and recording.cpp read them.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// The instruments of the attitude; those of light and power are in diagnosis/light/model.
std::vector<Key> sensor_keys();
Key recording_table();

}  // namespace photorque
