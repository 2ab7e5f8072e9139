// The catalogue of disturbances: what an experiment file may name in [[disturbance]].
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "attitude/model/disturbance.h"

namespace photorque {

// What a reader may look at besides its own settings.
struct DisturbanceContext {
  const Platform& platform;
  const Environment& environment;
};

struct DisturbanceKind {
  std::string name;     // "bearing_drag"
  std::string summary;  // one sentence of physics
  // Builds the disturbance from its table. InputError for what is missing or out of range; the
  // caller has read `kind`, and complains about keys that nobody read.
  Disturbance (*read)(const Settings& settings, const DisturbanceContext& context);
};

// All kinds, generated from CMakeLists.txt.
std::vector<DisturbanceKind> all_disturbance_kinds();

// One [[disturbance]]: the kind that `kind` names. InputError for an unknown kind.
Disturbance read_disturbance(const Settings& settings, const DisturbanceContext& context);
// All of `root`'s [[disturbance]], in their order.
std::vector<Disturbance> read_disturbances(const Settings& root, const DisturbanceContext& context);

// A disturbance from values in the units of their keys, as if an experiment file had held them:
//   make_disturbance_of("static_unbalance", {{"offset_m", {0, 0, -3e-5}}}, context)
// A single value makes a number, more make an array.
Disturbance make_disturbance_of(
    const std::string& kind, const std::vector<std::pair<std::string, std::vector<double>>>& values,
    const DisturbanceContext& context);

}  // namespace photorque
