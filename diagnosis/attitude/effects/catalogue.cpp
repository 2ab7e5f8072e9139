#include "diagnosis/attitude/effects/catalogue.h"

namespace photorque {
namespace {

EffectKey scaled(EffectKey key, double inertia_kg_m2) {
  if (!key.times_inertia) return key;
  for (double& start : key.start) start *= inertia_kg_m2;
  key.scale *= inertia_kg_m2;
  return key;
}

}  // namespace

std::vector<Effect> catalogue(const DisturbanceContext& context) {
  const Platform& platform = context.platform;
  const double inertia_kg_m2 = platform.inertia_kg_m2.trace() / 3.0;
  std::vector<Effect> all;
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    const auto own = kind.screening.of_experiment;
    const std::vector<Parametrisation> ways =
        own != nullptr ? own(context) : kind.screening.parametrisations;
    for (const Parametrisation& p : ways) {
      if (p.of_free_bodies && platform.has_bearing()) continue;
      Effect effect{kind.name, {}, p.explanation, kind.screening, p.of_free_bodies};
      for (const EffectKey& key : p.keys) effect.keys.push_back(scaled(key, inertia_kg_m2));
      all.push_back(std::move(effect));
    }
  }
  return all;
}

Disturbance disturbance_of(const Effect& effect, const DisturbanceContext& context) {
  std::vector<std::pair<std::string, std::vector<double>>> values;
  for (const EffectKey& key : effect.keys) values.emplace_back(key.key, key.start);
  return make_disturbance_of(effect.kind, values, context);
}

}  // namespace photorque
