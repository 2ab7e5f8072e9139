#include "diagnosis/report/light_charts.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/text/format.h"

namespace photorque {
namespace {

constexpr size_t most_bins_across = 400;

// Coordinates that differ by less than a tenth of the step between neighbours are one.
std::vector<double> distinct(std::vector<double> values) {
  std::ranges::sort(values);
  const double span = values.back() - values.front();
  const double least = std::max(1e-9, 1e-4 * span);
  std::vector<double> all;
  for (const double value : values) {
    if (all.empty() || value - all.back() > least) all.push_back(value);
  }
  return all;
}

// The places of a scan, or, where they lie on no grid, as many as there are readings.
Steps steps_of(const std::vector<double>& values, size_t readings) {
  const std::vector<double> all = distinct(values);
  if (all.size() == 1) return {all.front(), 0.01, 1};
  std::vector<double> gaps;
  for (size_t i = 1; i < all.size(); ++i) gaps.push_back(all[i] - all[i - 1]);
  std::ranges::nth_element(gaps, gaps.begin() + static_cast<ptrdiff_t>(gaps.size() / 2));
  const double span = all.back() - all.front();
  double step = gaps[gaps.size() / 2];
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
      {"after", "Measured minus model with what was found", true,
       [](const LightSeries& l, size_t i) { return l.measured[i] - l.after[i]; }}};
  return all;
}

}  // namespace

// "tilt 12 deg, heading 60 deg"
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
  Plot plot;
  plot.name = "sweep_" + std::to_string(sweep) + "_of_" + recording.recording;
  plot.title = "Curve " + std::to_string(sweep) + " of " + recording.recording +
               (recording.is_held_out ? ", never fitted" : "");
  plot.x_label = "Voltage [V]";
  plot.y_label = "Current [A]";
  Plot::Curve measured, before, after, off_before, off_after;
  measured.dots = true;
  measured.colour = Plot::Colour::grey;
  before.dashed = true;
  before.colour = off_before.colour = Plot::Colour::vermilion;
  after.colour = off_after.colour = Plot::Colour::blue;
  measured.label = "measured";
  before.label = "nominal model";
  after.label = "with what was found";
  off_before.label = "measured minus nominal model";
  off_after.label = "measured minus model with what was found";
  std::vector<size_t> rows;
  for (size_t i = 0; i < light.measured.size(); ++i) {
    if (light.sweep.empty() || light.sweep[i] == sweep) rows.push_back(i);
  }
  std::ranges::stable_sort(rows, {}, [&](size_t i) { return light.voltage_V[i]; });
  for (const size_t i : rows) {
    for (Plot::Curve* curve : {&measured, &before, &after, &off_before, &off_after}) {
      curve->x.push_back(light.voltage_V[i]);
    }
    measured.y.push_back(light.measured[i]);
    before.y.push_back(light.before[i]);
    after.y.push_back(light.after[i]);
    off_before.y.push_back(light.measured[i] - light.before[i]);
    off_after.y.push_back(light.measured[i] - light.after[i]);
  }
  plot.curves = {std::move(measured), std::move(before)};
  Plot::Panel residual{"Difference [A]", {std::move(off_before)}};
  if (something_was_found) {
    plot.curves.push_back(std::move(after));
    residual.curves.push_back(std::move(off_after));
  }
  plot.below = {std::move(residual)};
  return plot;
}

std::string array_drawing(const Diagnosis& d) {
  if (!d.array) return "";
  const DrawnArray& array = *d.array;
  double u_low = 1e300, u_high = -1e300, v_low = 1e300, v_high = -1e300;
  for (const DrawnArray::Cell& c : array.cells) {
    u_low = std::min(u_low, c.u_low);
    u_high = std::max(u_high, c.u_high);
    v_low = std::min(v_low, c.v_low);
    v_high = std::max(v_high, c.v_high);
  }
  constexpr double width = 560.0, margin = 8.0, most_numbers = 400.0;
  const double scale = (width - 2.0 * margin) / (u_high - u_low);
  const double height = scale * (v_high - v_low) + 2.0 * margin;
  const auto box = [&](double a, double b, double c, double e) {
    const auto place = [](const char* name, double value) {
      return " " + std::string(name) + "=\"" + readable_number(value, 5) + "\"";
    };
    return place("x", margin + scale * (a - u_low)) + place("y", margin + scale * (v_high - e)) +
           place("width", scale * (b - a)) + place("height", scale * (e - c));
  };
  std::string svg =
      "<svg class=\"chart array\" role=\"img\" aria-label=\"the array\" viewBox=\"0 0 " +
      readable_number(width, 5) + " " + readable_number(height, 5) + "\">\n";
  for (size_t k = 0; k < array.cells.size(); ++k) {
    const DrawnArray::Cell& c = array.cells[k];
    const bool is_suspect = std::ranges::find(array.suspects, k) != array.suspects.end();
    svg += std::string("<rect class=\"") + (is_suspect ? "suspect" : "cell") + "\"" +
           box(c.u_low, c.u_high, c.v_low, c.v_high) + "/>\n";
    if (static_cast<double>(array.cells.size()) > most_numbers) continue;
    const double high = scale * (c.v_high - c.v_low), wide = scale * (c.u_high - c.u_low);
    const double size = std::clamp(0.3 * std::min(high, wide), 6.0, 15.0);
    svg +=
        "<text x=\"" + readable_number(margin + scale * (0.5 * (c.u_low + c.u_high) - u_low), 5) +
        "\" y=\"" +
        readable_number(margin + scale * (v_high - 0.5 * (c.v_low + c.v_high)) + 0.36 * size, 5) +
        "\" font-size=\"" + readable_number(size, 3) + "\" text-anchor=\"middle\">" +
        std::to_string(k) + "</text>\n";
  }
  for (const DrawnArray::Cell& s : array.shadows) {
    svg += "<rect class=\"shadow\"" + box(s.u_low, s.u_high, s.v_low, s.v_high) + "/>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace photorque
