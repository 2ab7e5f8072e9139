// Where on the array something was found.
#include <algorithm>

#include "diagnosis/light/account.h"
#include "scenes/effects/kind.h"

namespace photorque {
namespace {

// Cells of one string, or of one bypass diode, by its number along the serpentine.
std::vector<size_t> wired_cells(const ArrayWiring& wiring, bool of_string, size_t number) {
  std::vector<size_t> cells;
  size_t string = 0, bypass = 0;
  for (const ArrayWiring::String& s : wiring.strings) {
    for (const ArrayWiring::Substring& part : s.substrings) {
      if ((of_string ? string : bypass) == number) {
        for (const std::vector<int>& row : part.rows) {
          cells.insert(cells.end(), row.begin(), row.end());
        }
      }
      ++bypass;
    }
    ++string;
  }
  return cells;
}

// What the index of a kind counts.
LightEffectKind::Index index_of(const std::string& kind) {
  static const std::vector<LightEffectKind> kinds = all_light_effect_kinds();
  const auto known = std::ranges::find(kinds, kind, &LightEffectKind::name);
  return known == kinds.end() ? LightEffectKind::Index::none : known->index;
}

const std::vector<double>* found_numbers(const FoundEffect& effect, const std::string& key) {
  const auto found = std::ranges::find(effect.parameters, key, &FittedParameter::key);
  return found == effect.parameters.end() ? nullptr : &found->value;
}

}  // namespace

std::optional<DrawnArray> drawn_array(const LightLab& lab,
                                      const std::vector<FoundEffect>& effects) {
  if (!lab.has_array() || effects.empty()) return std::nullopt;
  DrawnArray array;
  for (const LightCell& cell : lab.cells()) {
    const CellRectangle& r = cell.rectangle;
    array.cells.push_back({r.u_low, r.u_high, r.v_low, r.v_high});
  }
  for (const FoundEffect& effect : effects) {
    const auto *u = found_numbers(effect, "u_m"), *v = found_numbers(effect, "v_m");
    if (u != nullptr && v != nullptr && u->size() == 2 && v->size() == 2) {
      array.shadows.push_back({(*u)[0], (*u)[1], (*v)[0], (*v)[1]});
    }
    const std::vector<double>* index = found_numbers(effect, "index");
    if (index == nullptr) continue;
    const auto number = static_cast<size_t>(index->front());
    const LightEffectKind::Index of = index_of(effect.kind);
    if (of == LightEffectKind::Index::cell) array.suspects.push_back(number);
    const bool of_string = of == LightEffectKind::Index::string;
    if (!of_string && of != LightEffectKind::Index::bypass) continue;
    const std::vector<size_t> cells = wired_cells(lab.design().wiring, of_string, number);
    array.suspects.insert(array.suspects.end(), cells.begin(), cells.end());
  }
  return array;
}

}  // namespace photorque
