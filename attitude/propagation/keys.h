// [propagate] as it is declared; run.cpp reads it.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key propagate_table();

}  // namespace photorque
