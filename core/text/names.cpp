#include "core/text/names.h"

#include "core/settings/settings.h"

namespace photorque {

std::string listed_names(std::set<std::string> names, std::string_view wanted) {
  constexpr size_t most = 12;
  names.erase("");
  if (names.empty()) return "none";
  const std::string likest = nearest(wanted, names);
  std::string text = likest.empty() ? "" : "perhaps \"" + likest + "\"";
  if (!likest.empty() && names.size() == 1) return text;
  if (!likest.empty()) text += ", of ";
  size_t count = 0;
  for (const std::string& name : names) {
    if (++count > most) break;
    text += (count == 1 ? "\"" : ", \"") + name + "\"";
  }
  if (names.size() > most) text += " and " + std::to_string(names.size() - most) + " more";
  return text;
}

}  // namespace photorque
