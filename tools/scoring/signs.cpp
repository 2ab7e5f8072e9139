#include "tools/scoring/signs.h"

#include <algorithm>

#include "attitude/disturbances/kind.h"

namespace photorque {

bool is_possible(const std::string& kind, const std::string& key, const std::vector<double>& values,
                 bool nominal_has_kind) {
  const DisturbanceKind* known = find_kind(kind);
  if (known == nullptr) return true;
  double lowest = -EffectKey::unbounded, highest = EffectKey::unbounded;
  bool stated = false;
  for (const Parametrisation& parametrisation : known->screening.parametrisations) {
    for (const EffectKey& k : parametrisation.keys) {
      if (k.key != key) continue;
      stated = true;
      lowest = std::max(lowest, k.lowest);
      highest = std::min(highest, k.highest);
    }
  }
  if (stated && known->screening.least_sum && !nominal_has_kind) {
    lowest = std::max(lowest, known->screening.least_sum->lowest);
  }
  return std::ranges::all_of(values, [&](double v) { return v >= lowest && v <= highest; });
}

}  // namespace photorque
