#include "tools/runs/published.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {

std::vector<PublishedFigure> read_published(const std::vector<Settings>& tables) {
  std::vector<PublishedFigure> figures;
  for (const Settings& table : tables) {
    PublishedFigure figure;
    figure.quantity = table.text("quantity");
    figure.value = table.number("value");
    figure.tilt_rad = table.number_or("tilt_deg", 0.0, {0.0, pi});
    if (table.has("rounded_to")) figure.rounded_to = table.number("rounded_to", Range::positive());
    figure.source = table.text("source");
    figure.why = table.text_or("why", "");
    figures.push_back(std::move(figure));
    table.finish();
  }
  return figures;
}

Product compare_published(const std::vector<PublishedFigure>& figures, double tilt_rad,
                          const Product& product, const Console& console) {
  Table table = Table::of(
      "published", "Published figures beside ours",
      {"quantity", "source", "why", "published", "rounded_to", "ours", "standard_error", "ratio"});
  std::optional<double> misfit;
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
          .set("rounded_to", figure.rounded_to.value_or(std::nan("")))
          .set("ours", ours)
          .set("standard_error", quantity.estimate.standard_error)
          .set("ratio", figure.value == 0.0 ? std::nan("") : ours / figure.value);
      std::string verdict;
      if (figure.rounded_to) {
        const double off = (ours - figure.value) / (0.5 * *figure.rounded_to);
        misfit = misfit.value_or(0.0) + off * off;
        verdict = std::abs(off) <= 1.0 ? "; within its printed digits"
                                       : "; beyond its printed digits, " +
                                             show(0.5 * std::abs(off)) + " of the last one";
      }
      console.line("  " + figure.quantity + ": published " + show(figure.value) + ", ours " +
                   show(quantity.estimate, "") +
                   (figure.value == 0.0 ? "" : " (ratio " + show(ours / figure.value) + ")") +
                   verdict);
      if (!figure.why.empty()) console.line("    " + figure.why);
    }
  }
  Product compared;
  if (!table.column("quantity").texts.empty()) compared.tables.push_back(std::move(table));
  if (misfit) compared.quantities.push_back({"published_misfit", {*misfit, 0.0}});
  return compared;
}

}  // namespace photorque
