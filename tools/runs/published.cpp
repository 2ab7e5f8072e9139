#include "tools/runs/published.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {

std::vector<PublishedFigure> read_published(const std::vector<Settings>& tables) {
  std::vector<PublishedFigure> figures;
  for (const Settings& table : tables) {
    figures.push_back({table.text("quantity"), table.number("value"),
                       table.number_or("tilt_deg", 0.0, {0.0, pi}), table.text("source"),
                       table.text_or("why", "")});
    table.finish();
  }
  return figures;
}

Table compare_published(const std::vector<PublishedFigure>& figures, double tilt_rad,
                        const Product& product, const Console& console) {
  Table table =
      Table::of("published", "Published figures beside ours",
                {"quantity", "source", "why", "published", "ours", "standard_error", "ratio"});
  for (const PublishedFigure& figure : figures) {
    if (std::abs(figure.tilt_rad - tilt_rad) > 1e-6) continue;
    for (const Quantity& quantity : product.quantities) {
      if (quantity.name != figure.quantity) continue;
      if (table.column("quantity").texts.empty()) console.heading("Published figures beside ours");
      const double ours = quantity.estimate.value;
      table.row()
          .set("quantity", figure.quantity)
          .set("source", figure.source)
          .set("why", figure.why)
          .set("published", figure.value)
          .set("ours", ours)
          .set("standard_error", quantity.estimate.standard_error)
          .set("ratio", figure.value == 0.0 ? std::nan("") : ours / figure.value);
      console.line("  " + figure.quantity + ": published " + show(figure.value) + ", ours " +
                   show(quantity.estimate, "") +
                   (figure.value == 0.0 ? "" : " (ratio " + show(ours / figure.value) + ")"));
      if (!figure.why.empty()) console.line("    " + figure.why);
    }
  }
  if (table.column("quantity").texts.empty()) table.columns.clear();
  return table;
}

}  // namespace photorque
