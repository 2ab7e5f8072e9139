// [budget] and [balance] as they are declared.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key budget_table();
Key balance_table();

}  // namespace photorque
