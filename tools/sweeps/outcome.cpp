#include "tools/sweeps/outcome.h"

#include <algorithm>

namespace photorque {

std::vector<Figure> figures_of(std::span<const Quantity> quantities) {
  std::vector<Figure> figures;
  figures.reserve(quantities.size());
  for (const Quantity& q : quantities) figures.push_back({FigureName(q.name), q.estimate});
  return figures;
}

const Figure* find_figure(std::span<const Figure> figures, const std::string& name) {
  const auto at =
      std::ranges::find_if(figures, [&](const Figure& f) { return f.name.text() == name; });
  return at == figures.end() ? nullptr : &*at;
}

void FigureNames::share(std::vector<Figure>& figures) {
  for (Figure& f : figures) f.name = known_.try_emplace(f.name.text(), f.name).first->second;
}

}  // namespace photorque
