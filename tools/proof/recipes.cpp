#include "tools/proof/recipes.h"

#include <algorithm>

#include "attitude/disturbances/kind.h"
#include "core/errors.h"
#include "tools/proof/outside.h"

namespace photorque::injected {
namespace {

// The key of the first parametrisation that makes the effect strong; null: it has no numbers.
const EffectKey* strength_key(const Recipe& recipe) {
  if (recipe.screening.parametrisations.empty()) return nullptr;
  for (const EffectKey& key : recipe.screening.parametrisations.front().keys) {
    if (key.key == recipe.injection.strength) return &key;
  }
  return nullptr;
}

std::vector<Recipe> make_recipes() {
  std::vector<Recipe> all;
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    if (!kind.injection.draw) continue;
    all.push_back({kind.name, kind.injection, kind.screening, kind.instrument});
  }
  for (const OutsideLaw& law : outside_laws()) {
    all.push_back({law.name, law.injection, {}, {}, true, law.depends_on});
  }
  return all;
}

}  // namespace

bool Recipe::is_proportional() const {
  if (outside) return true;
  const EffectKey* key = strength_key(*this);
  return key != nullptr && !key->searched;
}

size_t Recipe::strengths() const {
  const EffectKey* key = strength_key(*this);
  return key == nullptr ? 0 : key->start.size();
}

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all = make_recipes();
  return all;
}

const Recipe& recipe_of(const std::string& kind) {
  const auto found =
      std::ranges::find_if(recipes(), [&](const Recipe& r) { return r.kind == kind; });
  if (found == recipes().end()) throw NumericalError("no injected law is called " + kind);
  return *found;
}

}  // namespace photorque::injected
