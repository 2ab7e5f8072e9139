#include "core/text/json_extent.h"

#include <algorithm>

namespace photorque {

JsonExtent extent_of_json(std::string_view text) {
  JsonExtent extent;
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '{' || c == '[' || c == ',' || c == ':') ++extent.values;
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    extent.depth = std::max(extent.depth, depth);
  }
  return extent;
}

}  // namespace photorque
