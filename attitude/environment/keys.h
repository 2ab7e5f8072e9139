// [environment] as it is declared; environment.cpp reads it.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key environment_table();

}  // namespace photorque
