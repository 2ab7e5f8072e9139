#include "tools/pages/charts.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/median.h"
#include "core/text/format.h"
#include "images/drawing/canvas.h"

namespace photorque {

std::string name_in_text(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

namespace {

std::string name_of(const Alternative& alternative) {
  if (!alternative.label.empty()) return name_in_text(alternative.label);
  const std::string name = joined_text(alternative.kinds, " + ", name_in_text);
  return name.empty() ? "nothing missing" : name;
}

// The length of a bar shows the evidence; the note states the difference to the best alternative.
std::string note_on(const Alternative& alternative, double best_log_evidence) {
  if (!alternative.remark.empty()) return name_in_text(alternative.remark);
  const double behind = best_log_evidence - alternative.log_evidence_relative;
  std::string note = behind > 0.0 ? "−" + readable_number(behind, 3) + " to the best" : "";
  if (alternative.holdout_chi2_per_sample) {
    note += (note.empty() ? "" : "; ") +
            ("χ² held out " + readable_number(*alternative.holdout_chi2_per_sample, 3));
  }
  return note;
}

Plot::Curve curve_through(const std::vector<double>& x, const std::vector<double>& y,
                          Plot::Colour colour, double width) {
  return {.x = x, .y = y, .colour = colour, .width = width};
}

std::vector<Plot::Curve> readings_and_models(const ChannelSeries& channel) {
  Plot::Curve measured = curve_through(channel.time_s, channel.measured, Plot::Colour::grey, 1.2);
  measured.dots = true;
  Plot::Curve before = curve_through(channel.time_s, channel.before, Plot::Colour::vermilion, 1.4);
  before.dashed = true;
  return {measured, before, curve_through(channel.time_s, channel.after, Plot::Colour::blue, 1.4)};
}

constexpr size_t most_bins_across = 400;

// Coordinates that differ by less than 1e-4 of the range count as one.
std::vector<double> distinct_places(std::vector<double> values) {
  std::ranges::sort(values);
  const double span = values.back() - values.front();
  const double least = std::max(1e-9, 1e-4 * span);
  std::vector<double> all;
  for (const double value : values) {
    if (all.empty() || value - all.back() > least) all.push_back(value);
  }
  return all;
}

Steps steps_of(const std::vector<double>& values, size_t readings) {
  const std::vector<double> all = distinct_places(values);
  if (all.size() == 1) return {all.front(), 0.01, 1};
  std::vector<double> gaps;
  for (size_t i = 1; i < all.size(); ++i) gaps.push_back(all[i] - all[i - 1]);
  const double span = all.back() - all.front();
  double step = upper_median(gaps);
  const double most =
      std::min(static_cast<double>(most_bins_across), static_cast<double>(readings));
  if (!(span / step < most)) step = span / std::sqrt(static_cast<double>(readings));
  const auto count = static_cast<size_t>(std::lround(span / step)) + 1;
  return {all.front(), span / static_cast<double>(std::max<size_t>(1, count - 1)), count};
}

const std::vector<ScanView>& scan_views() {
  static const std::vector<ScanView> all = {
      {"measured", "Measured", false, [](const LightSeries& l, size_t i) { return l.measured[i]; }},
      {"nominal", "Nominal model", false,
       [](const LightSeries& l, size_t i) { return l.before[i]; }},
      {"residual", "Measured minus nominal model", true,
       [](const LightSeries& l, size_t i) { return l.measured[i] - l.before[i]; }},
      {"after", "Measured minus improved model", true,
       [](const LightSeries& l, size_t i) { return l.measured[i] - l.after[i]; }}};
  return all;
}

}  // namespace

Plot empirical_plot(const EmpiricalTorque& torque) {
  Plot plot{"empirical_torque", "Empirical torque over " + name_in_text(torque.variable),
            name_in_text(torque.variable) + " [" + torque.unit + "]", "torque [N m]"};
  plot.levels = {0.0};
  const std::string axes = torque.about_lab_axes ? "about lab " : "about body ";
  constexpr std::array colours = {Plot::Colour::blue, Plot::Colour::vermilion, Plot::Colour::green};
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Vec3& t : torque.torque_N_m) values.push_back(t[k]);
    Plot::Curve curve = curve_through(torque.at, values, colours[static_cast<size_t>(k)], 2.0);
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
    if (!(d.strength > 0.0)) continue;
    chart.bars.push_back({name_in_text(d.variable), 100.0 * d.strength, "", chart.bars.empty()});
  }
  return chart;
}

BarChart ranking_chart(const Diagnosis& d, const std::string& of) {
  constexpr size_t max_bars = 14;
  // Alternatives that the recordings rule out would compress the scale for the others.
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
  Plot::Panel residuals{
      "residual [" + channel.residual_unit + "]",
      {curve_through(channel.time_s, channel.residual_before, Plot::Colour::vermilion, 1),
       curve_through(channel.time_s, channel.residual_after, Plot::Colour::blue, 1)}};
  if (channel.noise > 0.0) residuals.levels = {-2.0 * channel.noise, 2.0 * channel.noise};
  residuals.robust_range = true;
  Plot plot{channel.name, channel.label.empty() ? channel.name : channel.label, "time [s]", ""};
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
  plot.shaded_label = "held out";
  return plot;
}

std::string attitude_words(const Quat& lab_from_body) {
  const Vec3 up = lab_from_body * Vec3::UnitZ();
  const auto whole = [](double angle_rad) {
    return readable_number(std::round(angle_rad / degree_rad * 10.0) / 10.0, 3);
  };
  const double tilt = std::atan2(up.head<2>().norm(), up.z());
  if (tilt < 0.01 * degree_rad) return "tilt 0";
  return "tilt " + whole(tilt) + " deg, heading " + whole(std::atan2(up.y(), up.x())) + " deg";
}

std::vector<ScanGroup> scan_groups(const std::vector<RecordingSeries>& recordings) {
  std::vector<ScanGroup> groups;
  for (const RecordingSeries& recording : recordings) {
    if (!recording.light || recording.light->u_m.empty()) continue;
    const size_t before = groups.size();
    for (size_t i = 0; i < recording.light->measured.size(); ++i) {
      const Quat& q = recording.light->lab_from_body[i];
      const auto at = std::find_if(
          groups.begin() + static_cast<ptrdiff_t>(before), groups.end(),
          [&](const ScanGroup& group) { return group.lab_from_body.angularDistance(q) < 1e-6; });
      if (at == groups.end()) {
        groups.push_back({&recording, q, {i}});
      } else {
        at->rows.push_back(i);
      }
    }
  }
  return groups;
}

std::optional<size_t> Steps::at(double value) const {
  const double k = std::round((value - first) / step);
  if (!(k >= 0.0) || k >= static_cast<double>(count)) return std::nullopt;
  return static_cast<size_t>(k);
}

ScanGrid grid_of(const ScanGroup& group) {
  std::vector<double> u, v;
  for (const size_t i : group.rows) {
    u.push_back(group.recording->light->u_m[i]);
    v.push_back(group.recording->light->v_m[i]);
  }
  return {steps_of(u, group.rows.size()), steps_of(v, group.rows.size())};
}

std::vector<ScanView> views_of_scans(bool found) {
  std::vector<ScanView> all = scan_views();
  if (!found) all.pop_back();
  return all;
}

Map scan_map(const ScanGroup& group, const ScanView& shown, size_t number) {
  const LightSeries& light = *group.recording->light;
  const ScanGrid grid = grid_of(group);
  Map map;
  map.name = std::string(shown.name) + "_" + std::to_string(number);
  map.title = std::string(shown.title) + ": " + group.name();
  map.unit = "W/m²";
  map.width = static_cast<int>(grid.u.count);
  map.height = static_cast<int>(grid.v.count);
  map.x_low = grid.u.low();
  map.x_high = grid.u.high();
  map.y_low = grid.v.low();
  map.y_high = grid.v.high();
  map.x_label = "u [m]";
  map.y_label = "v [m]";
  map.signed_values = shown.is_difference;
  const size_t bins = grid.u.count * grid.v.count;
  map.value.assign(bins, NAN);
  std::vector<double> sum(bins, 0.0), variance(bins, 0.0), count(bins, 0.0);
  for (const size_t i : group.rows) {
    const auto x = grid.u.at(light.u_m[i]), y = grid.v.at(light.v_m[i]);
    if (!x || !y) continue;
    const size_t bin = *y * grid.u.count + *x;
    sum[bin] += shown.value(light, i);
    variance[bin] += light.noise.empty() ? 0.0 : light.noise[i] * light.noise[i];
    count[bin] += 1.0;
  }
  const bool has_error = std::string(shown.name) != "nominal" && !light.noise.empty();
  if (has_error) map.standard_error.assign(bins, 0.0);
  for (size_t bin = 0; bin < bins; ++bin) {
    if (!(count[bin] > 0.0)) continue;
    map.value[bin] = sum[bin] / count[bin];
    if (has_error) map.standard_error[bin] = std::sqrt(variance[bin]) / count[bin];
  }
  return map;
}

std::vector<int> sweeps_of(const LightSeries& light) {
  std::vector<int> sweeps = light.sweep;
  if (sweeps.empty()) sweeps = {0};
  std::ranges::sort(sweeps);
  sweeps.erase(std::ranges::unique(sweeps).begin(), sweeps.end());
  return sweeps;
}

Plot sweep_plot(const RecordingSeries& recording, int sweep, bool something_was_found) {
  const LightSeries& light = *recording.light;
  const bool is_only = sweeps_of(light).size() == 1;
  Plot plot{"sweep_" + std::to_string(sweep) + "_of_" + recording.recording,
            "Curve " + (is_only ? "" : std::to_string(sweep) + " ") + "of " + recording.recording +
                (recording.is_held_out ? ", held out" : ""),
            "voltage [V]", "current [A]"};
  std::vector<size_t> rows;
  for (size_t i = 0; i < light.measured.size(); ++i) {
    if (light.sweep.empty() || light.sweep[i] == sweep) rows.push_back(i);
  }
  std::ranges::stable_sort(rows, {}, [&](size_t i) { return light.voltage_V[i]; });
  const auto curve = [&](const char* label, Plot::Colour colour, const auto& value) {
    Plot::Curve one;
    one.label = label;
    one.colour = colour;
    for (const size_t i : rows) {
      one.x.push_back(light.voltage_V[i]);
      one.y.push_back(value(i));
    }
    return one;
  };
  const auto of = [](const std::vector<double>& series) {
    return [&series](size_t i) { return series[i]; };
  };
  const auto off = [&](const std::vector<double>& model) {
    return [&light, &model](size_t i) { return light.measured[i] - model[i]; };
  };
  plot.curves = {curve("measured", Plot::Colour::grey, of(light.measured)),
                 curve("nominal model", Plot::Colour::vermilion, of(light.before))};
  plot.curves[0].dots = true;
  plot.curves[1].dashed = true;
  Plot::Panel residual{"difference [A]",
                       {curve("measured − nominal", Plot::Colour::vermilion, off(light.before))}};
  if (something_was_found) {
    plot.curves.push_back(curve("improved model", Plot::Colour::blue, of(light.after)));
    residual.curves.push_back(curve("measured − improved", Plot::Colour::blue, off(light.after)));
  }
  plot.below = {std::move(residual)};
  return plot;
}

std::string array_html(const DrawnArray& array) {
  Extent u, v;
  for (const DrawnArray::Cell& c : array.cells) {
    for (const double edge : {c.u_low, c.u_high}) u.include(edge);
    for (const double edge : {c.v_low, c.v_high}) v.include(edge);
  }
  constexpr double width = 560.0, margin = 8.0, most_numbers = 400.0;
  constexpr Rgb plain = rgb_from_hex(0xE6EDF5), suspect = rgb_from_hex(0xE2864A);
  const double scale = (width - 2.0 * margin) / (u.high - u.low);
  const auto box_of_cell = [&](const DrawnArray::Cell& c) {
    return PageBox{margin + scale * (c.u_low - u.low), margin + scale * (v.high - c.v_high),
                   scale * (c.u_high - c.u_low), scale * (c.v_high - c.v_low)};
  };
  Canvas canvas = Canvas::of_svg(width, scale * (v.high - v.low) + 2.0 * margin);
  for (size_t k = 0; k < array.cells.size(); ++k) {
    const PageBox box = box_of_cell(array.cells[k]);
    const bool is_suspect = std::ranges::find(array.suspects, k) != array.suspects.end();
    canvas.fill(box, is_suspect ? suspect : plain);
    canvas.outline(box, {ink, 0.8});
    if (static_cast<double>(array.cells.size()) > most_numbers) continue;
    canvas.text(std::to_string(k), box.centre(),
                {.size = std::clamp(0.3 * std::min(box.height, box.width), 6.0, 15.0),
                 .align = TextAlign::centre,
                 .level = TextLevel::middle});
  }
  for (const DrawnArray::Cell& shadow : array.shadows) {
    canvas.fill(box_of_cell(shadow), ink, 0.35);
    canvas.outline(box_of_cell(shadow), {ink, 1.0, 1.0, {4.0, 3.0}});
  }
  return canvas.finish_html("the array");
}

}  // namespace photorque
