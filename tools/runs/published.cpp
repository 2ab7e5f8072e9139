#include "tools/runs/published.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

namespace published_key {
constexpr TextKey quantity("quantity", "name of the quantity in `summary.json`");
constexpr NumberKey value("value", {}, "published value, in its unit");
constexpr NumberKey tilt("tilt_deg", 0.0, {0.0, pi}, "tilt to which the value applies");
constexpr NumberKey rounded_to(
    "rounded_to", Range::positive(),
    "one unit of the last printed digit (38 %: 0.01). For `optimise`, `published_misfit` in the "
    "summary is the sum of ((computed − `value`)/(½ `rounded_to`))²; a figure that agrees "
    "contributes at most 1",
    {.optional = true});
constexpr TextKey source("source", "publication that contains the value");
constexpr TextKey why("why", "", "known reason of the difference, printed with it");
constexpr TablesKey published("published", "a published figure, compared at the same tilt");
}  // namespace published_key

}  // namespace

std::vector<PublishedFigure> read_published(const std::vector<Settings>& tables) {
  std::vector<PublishedFigure> figures;
  for (const Settings& table : tables) {
    PublishedFigure figure;
    figure.quantity = table.get(published_key::quantity);
    figure.value = table.get(published_key::value);
    figure.tilt_rad = table.get(published_key::tilt);
    if (table.has(published_key::rounded_to))
      figure.rounded_to = table.get(published_key::rounded_to);
    figure.source = table.get(published_key::source);
    figure.why = table.get(published_key::why);
    figures.push_back(std::move(figure));
    table.finish();
  }
  return figures;
}

Product compare_published(const std::vector<PublishedFigure>& figures, double tilt_rad,
                          const Product& product, const Console& console) {
  Table table = Table::of("published", "Published figures compared with photorque");
  std::optional<double> misfit;
  for (const PublishedFigure& figure : figures) {
    if (std::abs(figure.tilt_rad - tilt_rad) > 1e-6) continue;
    for (const Quantity& quantity : product.quantities) {
      if (quantity.name != figure.quantity) continue;
      if (table.columns.empty()) console.heading(table.title);
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
      console.line("  " + figure.quantity + ": published " + show(figure.value) + ", computed " +
                   show(quantity.estimate, "") +
                   (figure.value == 0.0 ? "" : " (ratio " + show_brief(ours / figure.value) + ")") +
                   verdict);
      if (!figure.why.empty()) console.details().line("    " + figure.why);
    }
  }
  Product compared;
  if (!table.columns.empty()) compared.tables.push_back(std::move(table));
  if (misfit) compared.quantities.push_back({"published_misfit", {*misfit, 0.0}});
  return compared;
}

Key published_table() {
  using namespace published_key;
  return published.of({quantity, value, tilt, rounded_to, source, why});
}

}  // namespace photorque
