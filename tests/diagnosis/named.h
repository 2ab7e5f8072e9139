// The names of a diagnosis, for tests.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"

namespace photorque {

inline std::vector<std::string> kinds_of(const Diagnosis& d) {
  std::vector<std::string> kinds;
  for (const FoundEffect& effect : d.effects) kinds.push_back(effect.kind);
  return kinds;
}

inline const FittedParameter& parameter(const Diagnosis& d, const std::string& kind,
                                        const std::string& key) {
  for (const FoundEffect& effect : d.effects) {
    for (const FittedParameter& p : effect.parameters) {
      if (effect.kind == kind && p.key == key) return p;
    }
  }
  throw std::runtime_error(kind + "." + key + " was not found");
}

}  // namespace photorque
