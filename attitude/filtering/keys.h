// [estimate] as it is declared; study.cpp reads it.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key estimate_table();

}  // namespace photorque
