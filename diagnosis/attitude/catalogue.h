// The effects that may be missing: every kind of disturbance that a recording can reveal, with what
// is known about its parameters before looking.
#pragma once

#include <string>
#include <vector>

#include "attitude/disturbances/kind.h"

namespace photorque {

// One key of an effect.
struct EffectKey {
  std::string key;            // as in an experiment file, SI
  std::vector<double> start;  // where a fit begins; its size is the number of components
  double scale = 1.0;         // size to be expected: the width of the prior
  double lowest = -1e308;     // bounds of physics
  double highest = 1e308;
  bool searched = false;  // enters nonlinearly: several starts are tried
};

struct Effect {
  std::string kind;
  std::vector<EffectKey> keys;
  std::string explanation;  // one sentence for the report
  std::string needs = {};   // a channel without which it cannot be told: "command", "charge"
};

// All effects that can be missing from this platform's model, scaled to its mass and inertia.
std::vector<Effect> catalogue(const Platform& platform);

// The disturbance with every parameter at its start.
Disturbance disturbance_of(const Effect& effect, const DisturbanceContext& context);

// Which key a parameter of that disturbance belongs to.
const EffectKey& key_of(const Effect& effect, const Parameter& parameter);

}  // namespace photorque
