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
  Table table{"published", "Published figures beside ours", {}};
  std::vector<Table::Column> columns = {
      {"quantity", {}, {}}, {"source", {}, {}},         {"why", {}, {}},  {"published", {}, {}},
      {"ours", {}, {}},     {"standard_error", {}, {}}, {"ratio", {}, {}}};
  for (const PublishedFigure& figure : figures) {
    if (std::abs(figure.tilt_rad - tilt_rad) > 1e-6) continue;
    for (const Quantity& quantity : product.quantities) {
      if (quantity.name != figure.quantity) continue;
      if (columns[0].texts.empty()) console.heading("Published figures beside ours");
      const double ours = quantity.estimate.value;
      columns[0].texts.push_back(figure.quantity);
      columns[1].texts.push_back(figure.source);
      columns[2].texts.push_back(figure.why);
      columns[3].values.push_back(figure.value);
      columns[4].values.push_back(ours);
      columns[5].values.push_back(quantity.estimate.standard_error);
      columns[6].values.push_back(figure.value == 0.0 ? std::nan("") : ours / figure.value);
      console.line("  " + figure.quantity + ": published " + show(figure.value) + ", ours " +
                   show(quantity.estimate, "") +
                   (figure.value == 0.0 ? "" : " (ratio " + show(ours / figure.value) + ")"));
      if (!figure.why.empty()) console.line("    " + figure.why);
    }
  }
  if (!columns[0].texts.empty()) table.columns = std::move(columns);
  return table;
}

}  // namespace photorque
