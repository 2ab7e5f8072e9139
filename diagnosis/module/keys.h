// [module] and its effects as they are declared; design.cpp reads them.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key module_table();
// The kinds of [[effect]] on a module, with their keys.
std::vector<Key::Choice> module_effects();

}  // namespace photorque
