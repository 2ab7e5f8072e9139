// Comparison of computed figures with published ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/settings/typed_keys.h"
#include "tools/runs/console.h"

namespace photorque {

// One `[[published]]` of an experiment file: a figure of summary.json at a tilt, in the unit at the
// end of its name.
struct PublishedFigure {
  std::string quantity;
  double value = 0.0;
  double tilt_rad = 0.0;
  std::optional<double> rounded_to;  // > 0
  std::string source;
  std::string why;
};
// Figures at tilts closer than this belong to one attitude.
inline constexpr double same_tilt_rad = 1e-6;
std::vector<PublishedFigure> read_published(const std::vector<Settings>& tables);
Key published_table();

// Table "published" of the figures at this tilt that `product` contains, with the ratio
// ours/published; prints it. If any of them states its rounding, also the quantity
// "published_misfit", Σ ((ours − published)/(½ rounded_to))². Empty if there is no such figure.
Product compare_published(const std::vector<PublishedFigure>& figures, double tilt_rad,
                          const Product& product, const Console& console);

}  // namespace photorque
