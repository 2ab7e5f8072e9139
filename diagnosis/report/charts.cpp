#include "diagnosis/report/charts.h"

#include <algorithm>

#include "core/text/format.h"
#include "diagnosis/report/text.h"

namespace photorque {
namespace {

std::string name_of(const Alternative& alternative) {
  if (!alternative.label.empty()) return spoken(alternative.label);
  std::string name;
  for (const std::string& kind : alternative.kinds) {
    name += (name.empty() ? "" : " + ") + spoken(kind);
  }
  return name.empty() ? "nothing missing" : name;
}

// Beside a bar that is as long as the best one's, only the difference says something.
std::string note_on(const Alternative& alternative, double best_log_evidence) {
  if (!alternative.remark.empty()) return spoken(alternative.remark);
  const double behind = best_log_evidence - alternative.log_evidence_relative;
  std::string note = behind > 0.0 ? "−" + readable_number(behind, 3) + " to the best" : "";
  if (alternative.holdout_chi2_per_sample) {
    note += (note.empty() ? "" : "; ") +
            ("χ² held out " + readable_number(*alternative.holdout_chi2_per_sample, 3));
  }
  return note;
}

Plot::Curve line(const std::vector<double>& x, const std::vector<double>& y, Plot::Colour colour,
                 double width) {
  Plot::Curve curve;
  curve.x = x;
  curve.y = y;
  curve.colour = colour;
  curve.width = width;
  return curve;
}

std::vector<Plot::Curve> readings_and_models(const ChannelSeries& channel) {
  Plot::Curve measured = line(channel.time_s, channel.measured, Plot::Colour::grey, 1.2);
  measured.dots = true;
  Plot::Curve before = line(channel.time_s, channel.before, Plot::Colour::vermilion, 1.4);
  before.dashed = true;
  return {measured, before, line(channel.time_s, channel.after, Plot::Colour::blue, 1.4)};
}

}  // namespace

Plot empirical_plot(const EmpiricalTorque& torque) {
  Plot plot;
  plot.name = "empirical_torque";
  plot.title = "Empirical torque over " + spoken(torque.variable);
  plot.x_label = spoken(torque.variable) + " [" + torque.unit + "]";
  plot.y_label = "torque [N m]";
  plot.levels = {0.0};
  const std::string axes = torque.about_lab_axes ? "about lab " : "about body ";
  constexpr std::array colours = {Plot::Colour::blue, Plot::Colour::vermilion, Plot::Colour::green};
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Vec3& t : torque.torque_N_m) values.push_back(t[k]);
    Plot::Curve curve = line(torque.at, values, colours[static_cast<size_t>(k)], 2.0);
    curve.label = axes + "xyz"[k];
    for (const Vec3& s : torque.standard_error_N_m) curve.y_error.push_back(s[k]);
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

BarChart misfit_chart(const Where& where) {
  BarChart chart{"misfit",
                 "Misfit of every channel under the nominal model",
                 "χ² per reading under the nominal model (1 is noise)",
                 {}};
  for (const Where::ChannelMisfit& c : where.channels) {
    chart.bars.push_back({c.name, c.chi2_per_sample, "", c.chi2_per_sample > 1.5});
  }
  return chart;
}

BarChart dependence_chart(const Where& where) {
  BarChart chart{"dependence",
                 "Dependence of the difference",
                 "fraction explained by a function of this alone [%]",
                 {}};
  for (const Where::Dependence& d : where.depends_on) {
    chart.bars.push_back({spoken(d.variable), 100.0 * d.strength, "", chart.bars.empty()});
  }
  return chart;
}

BarChart ranking_chart(const Diagnosis& d, const std::string& of) {
  constexpr size_t max_bars = 14;
  // Explanations that the recordings rule out would only flatten the rest.
  constexpr double ruled_out = -50.0;
  BarChart chart{
      "ranking", "Log evidence of the alternatives", "log evidence over “nothing missing”", {}};
  std::vector<std::string> chosen;
  for (const FoundEffect& effect : d.effects) {
    const bool is_of_light = effect.table == "effect";
    if (of.empty() || is_of_light == (of == "light")) chosen.push_back(effect.kind);
  }
  std::ranges::sort(chosen);
  const auto best = std::ranges::find(d.alternatives, of, &Alternative::of);
  for (const Alternative& a : d.alternatives) {
    if (a.of != of) continue;
    if (chart.bars.size() == max_bars) break;
    if (a.log_evidence_relative < ruled_out && !a.chosen) continue;
    std::vector<std::string> kinds = a.kinds;
    std::ranges::sort(kinds);
    const bool named = d.verdict != Verdict::unexplained && kinds == chosen && a.label.empty();
    chart.bars.push_back({name_of(a), a.log_evidence_relative,
                          note_on(a, best->log_evidence_relative), a.chosen || named});
  }
  return chart;
}

Plot channel_plot(const ChannelSeries& channel, const RecordingSeries& recording) {
  Plot::Panel residuals{"residual [" + channel.residual_unit + "]",
                        {line(channel.time_s, channel.residual_before, Plot::Colour::vermilion, 1),
                         line(channel.time_s, channel.residual_after, Plot::Colour::blue, 1)}};
  if (channel.noise > 0.0) residuals.levels = {-2.0 * channel.noise, 2.0 * channel.noise};
  residuals.robust_range = true;
  Plot plot;
  plot.name = channel.name;
  plot.title = channel.label.empty() ? channel.name : channel.label;
  plot.x_label = "time [s]";
  plot.robust_range = true;
  if (channel.measured.empty()) {
    plot.y_label = residuals.y_label;
    plot.curves = residuals.curves;
    plot.levels = residuals.levels;
  } else {
    plot.y_label = "reading [" + channel.unit + "]";
    plot.curves = readings_and_models(channel);
    plot.below = {residuals};
  }
  for (const auto& i : recording.held_out_s) plot.shaded.push_back({i.from, i.to});
  plot.shaded_label = "held out, never fitted";
  return plot;
}

}  // namespace photorque
