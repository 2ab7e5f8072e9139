#include "tools/runs/array_target.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr double same_tilt_rad = 1e-6;

std::optional<double> published_upright(const std::vector<PublishedFigure>& figures,
                                        const std::string& quantity) {
  for (const PublishedFigure& figure : figures) {
    if (figure.quantity == quantity && figure.tilt_rad < same_tilt_rad) return figure.value;
  }
  return std::nullopt;
}

double given_or_published(const Settings& target, const char* key, Range range,
                          const std::optional<double>& published) {
  return published ? target.number_or(key, *published, range) : target.number(key, range);
}

// Ours for a published power of the array; nothing for other figures.
std::optional<double> power_of(const ArrayResult& result, const std::string& quantity) {
  if (quantity == "array_power_W") return result.power_W.value;
  if (quantity == "power_of_cells_alone_W") return result.sum_of_cells_W.value;
  return std::nullopt;
}

void print_requirements(const Console& console, const ArrayTarget& target,
                        const ArrayResult& result, const LossInputs& light) {
  const double needed_V = target.efficiency * light.photon_V;
  console.heading("What " + show(target.power_W) + " W and " + show_percent(target.efficiency) +
                  " require");
  console.line("  a photon has " + show(light.photon_V) + " eV: at most " +
               show(1.0 / light.photon_V) + " A/W; " + show_percent(target.efficiency) +
               " needs EQE V_oc FF = " + show(needed_V) + " V");
  const double ours = result.efficiency.value;
  console.line("  light on the cells for it: " + show(target.power_W / target.efficiency) + " W" +
               (ours > 0.0 ? "; at this array's " + show_percent(ours) + ": " +
                                 show(target.power_W / ours) + " W"
                           : ""));
}

// Tilted, an array shows the cosine of its area; a published power below that tells what else was
// lost.
Table tilted_table(const Console& console, const ArrayTarget& target,
                   const std::vector<PublishedFigure>& published, const ArrayResult& result,
                   double tilt_rad) {
  Table table = Table::of("target", "Published powers of the tilted array",
                          {"quantity", "tilt_deg", "published_W", "cosine_W", "further_factor",
                           "ours_W", "our_further_factor"});
  for (const PublishedFigure& figure : published) {
    const auto ours_W = power_of(result, figure.quantity);
    constexpr double edge_on = 1e-6;
    if (!ours_W || figure.tilt_rad < same_tilt_rad || std::cos(figure.tilt_rad) < edge_on) continue;
    const double cosine_W = target.power_W * std::cos(figure.tilt_rad);
    const double degrees = figure.tilt_rad / degree_rad;
    const bool here = std::abs(figure.tilt_rad - tilt_rad) < same_tilt_rad;
    console.line(
        "  at " + show(degrees) + " deg: " + show(target.power_W) + " W cos = " + show(cosine_W) +
        " W; the published " + show(figure.value) + " W need a further " +
        show(figure.value / cosine_W) + ", from spill and uneven light" +
        (here ? "; here " + figure.quantity + " is " + show(*ours_W) + ", " +
                    show(*ours_W / cosine_W) + " of it, and the array gives " +
                    show(result.power_W.value) + " W, " + show(result.power_W.value / cosine_W)
              : ""));
    const double none = std::nan("");
    table.row()
        .set("quantity", figure.quantity)
        .set("tilt_deg", degrees)
        .set("published_W", figure.value)
        .set("cosine_W", cosine_W)
        .set("further_factor", figure.value / cosine_W)
        .set("ours_W", here ? *ours_W : none)
        .set("our_further_factor", here ? *ours_W / cosine_W : none);
  }
  return table;
}

Table known_cell_table(const Console& console, const ArrayDesign& design, const LossInputs& light,
                       double irradiance_W_m2) {
  Table known = Table::of(
      "known_cells", "Known cells in this light",
      {"cell", "irradiance_W_m2", "open_circuit_V", "fill_factor", "eqe_voc_ff_V", "efficiency"});
  for (const double irradiance : {1000.0, irradiance_W_m2}) {
    if (!(irradiance > 0.0)) continue;  // no light falls on the array
    console.line("  known cells at " + show(irradiance) + " W/m²:");
    for (const CellFigures& f : known_cell_figures(
             irradiance, light.photon_V, light.quantum_efficiency, design.temperature_K)) {
      console.line("    " + padded(f.name, 30) + "EQE V_oc FF " +
                   padded(show(f.product_V) + " V", 12) + show_percent(f.efficiency));
      known.row()
          .set("cell", f.name)
          .set("irradiance_W_m2", irradiance)
          .set("open_circuit_V", f.open_circuit_V)
          .set("fill_factor", f.fill_factor)
          .set("eqe_voc_ff_V", f.product_V)
          .set("efficiency", f.efficiency);
    }
  }
  return known;
}

Table sensitivity_table(const Console& console, const ArrayDesign& design,
                        const ArrayResult& result) {
  Table table =
      Table::of("sensitivities", "What changes the power", {"change", "power_W", "relative"});
  console.line("  what changes the power:");
  for (const ArraySensitivity& s : sensitivities(design, result)) {
    console.line("    " + padded(s.change, 34) + show_percent(s.relative));
    table.row().set("change", s.change).set("power_W", s.power_W).set("relative", s.relative);
  }
  return table;
}

}  // namespace

ArrayTarget read_array_target(const Settings& target,
                              const std::vector<PublishedFigure>& published) {
  return {given_or_published(target, "power_W", Range::positive(),
                             published_upright(published, "array_power_W")),
          given_or_published(target, "efficiency", {0.0, 1.0, true, false},
                             published_upright(published, "array_efficiency"))};
}

Product target_report(const Console& console, const ArrayTarget& target,
                      const std::vector<PublishedFigure>& published, const ArrayDesign& design,
                      const ArrayResult& result, const LossInputs& light, double tilt_rad) {
  Product product;
  print_requirements(console, target, result, light);
  Table tilted = tilted_table(console, target, published, result, tilt_rad);
  if (!tilted.column("quantity").texts.empty()) product.tables.push_back(std::move(tilted));
  const double irradiance = result.power_on_cells_W.value / result.area_of_cells_m2;
  product.tables.push_back(known_cell_table(console, design, light, irradiance));
  product.tables.push_back(sensitivity_table(console, design, result));
  return product;
}

}  // namespace photorque
