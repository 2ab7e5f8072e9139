// Whether fitted numbers are possible at all.
#pragma once

#include <string>
#include <vector>

namespace photorque {

// Whether all components of `key` of a disturbance lie within the bounds of physics that its kind
// states (EffectKey, and LeastSum where the nominal model has nothing of the kind). Kinds and keys
// that are not known are possible.
bool is_possible(const std::string& kind, const std::string& key, const std::vector<double>& values,
                 bool nominal_has_kind);

}  // namespace photorque
