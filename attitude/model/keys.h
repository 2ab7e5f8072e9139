// [platform] as it is declared; platform.cpp reads it.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key platform_table();

}  // namespace photorque
