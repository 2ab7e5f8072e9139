// The effects that may be missing: every kind of disturbance that a recording can reveal, with what
// is known about its parameters before looking. What is known stands in the kinds' own files.
#pragma once

#include <string>
#include <vector>

#include "attitude/disturbances/kind.h"

namespace photorque {

// One parametrisation of a kind.
struct Effect {
  std::string kind;
  std::vector<EffectKey> keys;  // scaled to the platform
  std::string explanation;      // one sentence for the report
  Screening how = {};           // what else the kind's file says about looking for it
  bool of_free_bodies = false;  // as in its parametrisation
};

// All effects that can be missing from the model of this platform, scaled to its mass and inertia.
std::vector<Effect> catalogue(const DisturbanceContext& context);

// The disturbance with every parameter at its start.
Disturbance disturbance_of(const Effect& effect, const DisturbanceContext& context);

}  // namespace photorque
