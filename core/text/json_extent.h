// How much a JSON text asks of who reads it, found before anything is built from it.
#pragma once

#include <cstdint>
#include <string_view>

namespace photorque {

struct JsonExtent {
  uint64_t values = 0;  // at most: each but the first follows one of [ { , : outside a string
  int depth = 0;        // of brackets within each other; libraries recurse once per level
};

JsonExtent extent_of_json(std::string_view text);

// Deeper than anything that programs write for each other.
inline constexpr int deepest_json = 256;

}  // namespace photorque
