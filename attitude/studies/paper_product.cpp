// The paper's figures as tables and a plot.
#include "attitude/disturbances/mass/sag_compliance.h"
#include "attitude/studies/paper_figures.h"
#include "core/constants.h"

namespace photorque {
namespace {

// Figure 5: both torques by tilt, as the trigonometric parts of eq. 2 and 3 over their largest
// value up to 90 deg.
Plot elastic_plot() {
  const DumbbellArms arms{Vec3::UnitX(), 1.0, 1.0, 0.0, 1.0};
  const CounterbalanceBeams beams{1.0, 1.0, 1.0, 1};
  Plot plot;
  plot.name = "elastic_torque_by_tilt";
  plot.title = "Elastic torque over its largest value, balanced at zero tilt";
  plot.x_label = "tilt [deg]";
  plot.y_label = "torque / largest torque";
  Plot::Curve dumbbell{"dumbbell", {}, {}, {}, false}, tabletop{"tabletop", {}, {}, {}, false};
  for (int tilt_deg = 0; tilt_deg <= 90; ++tilt_deg) {
    const double tilt_rad = tilt_deg * degree_rad;
    dumbbell.x.push_back(tilt_deg);
    dumbbell.y.push_back(sag_torque_N_m(arms, tilt_rad, 1.0) / sag_torque_N_m(arms, pi / 2, 1.0));
    tabletop.x.push_back(tilt_deg);
    tabletop.y.push_back(sag_torque_N_m(beams, tilt_rad, 1.0) / sag_torque_N_m(beams, pi / 4, 1.0));
  }
  plot.curves = {dumbbell, tabletop};
  return plot;
}

Table figures_table(const std::vector<PaperFigure>& figures) {
  Table table =
      Table::of("paper_figures", "Figures of the paper beside ours",
                {"quantity", "section", "why", "published", "ours", "ratio", "ours_as_published"});
  for (const PaperFigure& f : figures) {
    table.row()
        .set("quantity", f.quantity)
        .set("section", f.section)
        .set("why", f.why)
        .set("published", f.published)
        .set("ours", f.ours)
        .set("ratio", f.ours / f.published)
        .set("ours_as_published", f.as_published);
  }
  return table;
}

Table sensitivities_table(const std::vector<PaperSensitivity>& all) {
  Table table =
      Table::of("paper_sensitivities", "How the figures move with what the paper leaves out",
                {"quantity", "assumed", "value", "exponent", "value_for_published"});
  for (const PaperSensitivity& s : all) {
    table.row()
        .set("quantity", s.quantity)
        .set("assumed", s.input)
        .set("value", s.value)
        .set("exponent", s.exponent)
        .set("value_for_published", s.value_for_published);
  }
  return table;
}

}  // namespace

Product paper_product(const PaperInputs& inputs) {
  const PaperAirParts parts = paper_air_parts(inputs);
  std::vector<AirPart> all = parts.plates;
  all.insert(all.end(), parts.rails.begin(), parts.rails.end());
  all.insert(all.end(), parts.faces.begin(), parts.faces.end());
  constexpr double rate_rad_s = 2.0 * pi / 60.0;  // 1 rpm
  Table air = air_table(all, Air{}, rate_rad_s);
  air.name = "paper_external_air";
  air.title = "External air on the paper's platform at 1 rpm, by part";
  Product product;
  product.tables = {figures_table(paper_figures(inputs)),
                    sensitivities_table(paper_sensitivities(inputs)), air};
  product.plots = {elastic_plot()};
  return product;
}

}  // namespace photorque
