#include "core/text/names.h"

#include "core/settings/settings.h"

namespace photorque {

std::string listed_names(std::set<std::string> names, std::string_view wanted) {
  constexpr size_t most = 16;
  names.erase("");
  if (names.empty()) return "none";
  std::string text;
  size_t count = 0;
  for (const std::string& name : names) {
    if (++count > most) break;
    text += (count == 1 ? "\"" : ", \"") + name + "\"";
  }
  if (names.size() > most) text += " and " + std::to_string(names.size() - most) + " more";
  const std::string likest = nearest(wanted, names);
  return likest.empty() ? text : text + ", perhaps \"" + likest + "\"";
}

}  // namespace photorque
