// Names in messages.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace photorque {

// The names that a message offers instead of `wanted`: "perhaps \"b\", of \"a\", \"b\" and 7 more",
// at most 12 of them, the nearest by nearest() first. Empty names are left out; "none" if there is
// no other.
std::string listed_names(std::set<std::string> names, std::string_view wanted);

}  // namespace photorque
