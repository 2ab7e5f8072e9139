#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/text/display.h"
#include "raytrace/tracing/shown_rays.h"
#include "tools/pages/diagnosed.h"
#include "tools/pages/stage.h"

namespace photorque {
namespace {

constexpr size_t most_bins_across = 400;

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

// The rows of a scan at one attitude.
struct ScanGroup {
  const RecordingSeries* recording;
  Quat lab_from_body;
  std::vector<size_t> rows;
  std::string name() const { return recording->recording + ", " + attitude_words(lab_from_body); }
};

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

// One direction of a regular grid: where its first place is and how far apart they are.
struct Steps {
  double first = 0.0, step = 1.0;
  size_t count = 1;
  double low() const { return first - 0.5 * step; }
  double high() const { return first + (static_cast<double>(count) - 0.5) * step; }
  std::optional<size_t> at(double value) const {
    const double k = std::round((value - first) / step);
    if (!(k >= 0.0) || k >= static_cast<double>(count)) return std::nullopt;
    return static_cast<size_t>(k);
  }
};

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

struct ScanGrid {
  Steps u, v;
};

ScanGrid grid_of(const ScanGroup& group) {
  std::vector<double> u, v;
  for (const size_t i : group.rows) {
    u.push_back(group.recording->light->u_m[i]);
    v.push_back(group.recording->light->v_m[i]);
  }
  return {steps_of(u, group.rows.size()), steps_of(v, group.rows.size())};
}

// What a scan shows: readings, models, differences.
struct ScanView {
  const char* name;
  const char* title;
  bool is_difference;
  double (*value)(const LightSeries&, size_t);
};

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

// Bins of the receiver, as fine as the finest of some scans.
struct PaintedBins {
  int width = 1, height = 1;
};

PaintedBins painted_bins(const std::vector<ScanGroup>& groups, const SurfaceGrid& grid) {
  PaintedBins bins;
  const auto count = [](double span, double step) {
    return static_cast<int>(std::clamp(std::round(span / step), 1.0, 200.0));
  };
  for (const ScanGroup& group : groups) {
    const ScanGrid scan = grid_of(group);
    bins.width = std::max(bins.width, count(grid.u_high - grid.u_low, scan.u.step));
    bins.height = std::max(bins.height, count(grid.v_high - grid.v_low, scan.v.step));
  }
  return bins;
}

// A map of a scan laid on the whole receiver: where nothing was read stays empty.
Map on_receiver(const Map& scan, const SurfaceGrid& grid, const PaintedBins& bins) {
  Map map = scan;
  map.standard_error.clear();
  map.width = bins.width;
  map.height = bins.height;
  map.value.assign(static_cast<size_t>(map.width) * static_cast<size_t>(map.height), NAN);
  for (int y = 0; y < map.height; ++y) {
    const double v = grid.v_low + (y + 0.5) * (grid.v_high - grid.v_low) / map.height;
    const double row = std::floor((v - scan.y_low) / (scan.y_high - scan.y_low) * scan.height);
    if (!(row >= 0.0 && row < scan.height)) continue;
    for (int x = 0; x < map.width; ++x) {
      const double u = grid.u_low + (x + 0.5) * (grid.u_high - grid.u_low) / map.width;
      const double column = std::floor((u - scan.x_low) / (scan.x_high - scan.x_low) * scan.width);
      if (!(column >= 0.0 && column < scan.width)) continue;
      map.value[static_cast<size_t>(y * map.width + x)] =
          scan.value[static_cast<size_t>(row) * static_cast<size_t>(scan.width) +
                     static_cast<size_t>(column)];
    }
  }
  return map;
}

std::vector<ScanView> views_of_scans(bool found) {
  std::vector<ScanView> all = scan_views();
  if (!found) all.pop_back();
  return all;
}

void add_maps(const std::vector<ScanGroup>& groups, bool found, RunPage& page) {
  for (size_t g = 0; g < groups.size(); ++g) {
    for (const ScanView& shown : views_of_scans(found)) {
      page.product.maps.push_back(scan_map(groups[g], shown, g + 1));
    }
  }
}

double rms_off(const ScanGroup& group, const std::vector<double>& model) {
  double sum = 0.0;
  for (const size_t i : group.rows) {
    const double off = group.recording->light->measured[i] - model[i];
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(group.rows.size()));
}

// The scene with what was scanned painted on the receiver; nothing where the first receiver of
// light is no plane.
void show_scans(const std::vector<ScanGroup>& groups, const OpticalRun& run, bool found,
                RunPage& page) {
  const size_t index = run.flux_map_index("");
  const SurfaceGrid& grid = run.flux_map(index).grid();
  if (grid.over != SurfaceGrid::Over::plane) return;
  SceneStage stage = stage_of(run, StageMaps::own);
  stage.paintings.clear();
  stage.arrows.clear();
  const PaintedBins bins = painted_bins(groups, grid);
  for (const ScanView& shown : views_of_scans(found)) {
    Painting painting{shown.title, "W/m²", shown.is_difference, {}};
    painting.surfaces.push_back(painted_receiver(run, run.experiment().receivers[index].name));
    for (const ScanGroup& group : groups) {
      painting.surfaces.front().map_of_light.push_back(
          on_receiver(scan_map(group, shown, 1), grid, bins));
    }
    stage.paintings.push_back(std::move(painting));
  }
  stage.figures = {{"readings", ""}, {"RMS, measured minus nominal", "W/m²"}};
  if (found) stage.figures.push_back({"RMS, measured minus model found", "W/m²"});
  StageAxis axis{"scan", "", {}};
  for (const ScanGroup& group : groups) {
    axis.values.push_back(static_cast<double>(axis.values.size() + 1));
    axis.names.push_back(group.name());
    StageState state{{group.lab_from_body}};
    state.figures = {{static_cast<double>(group.rows.size()), 0.0},
                     {rms_off(group, group.recording->light->before), 0.0}};
    if (found) state.figures.push_back({rms_off(group, group.recording->light->after), 0.0});
    stage.states.push_back(std::move(state));
    stage.rays_of_light_lab_m.push_back(
        shown_rays(run.scene(), run.experiment().beams, {group.lab_from_body, Vec3::Zero()},
                   stage.radius_m, std::min<size_t>(400, 24'000 / groups.size())));
  }
  if (groups.size() > 1) stage.axes = {std::move(axis)};
  stage.remark = "Painted are the readings at the places where they were taken.";
  page.stage = std::move(stage);
}

// Runs: the platform over time in the light of the nominal model, what the array gave beside it.
void show_runs(const std::vector<RecordingSeries>& runs, const OpticalRun& optics, bool found,
               RunPage& page) {
  constexpr size_t most_states = 1500;
  SceneStage stage = stage_of(optics, StageMaps::own);
  stage.arrows.clear();
  const RecordingSeries& first = runs.front();
  const std::vector<double>& time_s = first.attitude.time_s;
  StageAxis axis{"time", "s", {}, true};
  std::vector<Quat> attitudes;
  for (const ChannelSeries& channel : first.channels) {
    stage.figures.push_back({channel.label + ", measured", channel.unit});
    stage.figures.push_back({"nominal model", channel.unit});
    if (found) stage.figures.push_back({"with what was found", channel.unit});
  }
  const size_t count = std::min(most_states, time_s.size());
  for (size_t k = 0; k < count; ++k) {
    const size_t i = count == 1 ? 0 : k * (time_s.size() - 1) / (count - 1);
    if (!axis.values.empty() && !(time_s[i] > axis.values.back())) continue;
    axis.values.push_back(time_s[i]);
    attitudes.push_back(first.attitude.measured[i]);
    StageState state{{attitudes.back()}};
    for (const ChannelSeries& channel : first.channels) {
      state.figures.push_back({channel.measured[i], channel.noise});
      state.figures.push_back({channel.before[i], 0.0});
      if (found) state.figures.push_back({channel.after[i], 0.0});
    }
    stage.states.push_back(std::move(state));
  }
  stage.axes = {std::move(axis)};
  stage.remark = "The motion and the light of the nominal model during " + first.recording + ".";
  light_along(stage, optics, attitudes);
  page.stage = std::move(stage);
}

// A sweep: points beside both models, and what they miss.
Plot sweep_plot(const RecordingSeries& recording, int sweep, bool found) {
  const LightSeries& light = *recording.light;
  Plot plot;
  plot.name = "sweep_" + std::to_string(sweep) + "_of_" + recording.recording;
  plot.title = recording.recording + ", curve " + std::to_string(sweep) +
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
  if (found) {
    plot.curves.push_back(std::move(after));
    residual.curves.push_back(std::move(off_after));
  }
  plot.below = {std::move(residual)};
  return plot;
}

void add_sweeps(const RecordingSeries& recording, bool found, RunPage& page) {
  constexpr size_t most_sweeps = 24;  // on a page
  std::vector<int> sweeps = recording.light->sweep;
  if (sweeps.empty()) sweeps = {0};
  std::ranges::sort(sweeps);
  sweeps.erase(std::ranges::unique(sweeps).begin(), sweeps.end());
  for (const int sweep : sweeps) {
    if (page.product.plots.size() == most_sweeps) {
      page.notes.push_back("More curves than " + std::to_string(most_sweeps) +
                           " were swept; the first of them are shown.");
      return;
    }
    page.product.plots.push_back(sweep_plot(recording, sweep, found));
  }
}

// The scene at the attitudes of the sweeps, in the light of the nominal model.
void show_attitudes(const std::vector<RecordingSeries>& sweeps, const OpticalRun& run,
                    RunPage& page) {
  constexpr size_t most_attitudes = 12;
  SceneStage stage = stage_of(run, StageMaps::own);
  stage.arrows.clear();
  StageAxis axis{"attitude", "", {}};
  std::vector<Quat> attitudes;
  for (const RecordingSeries& recording : sweeps) {
    for (const Quat& q : recording.light->lab_from_body) {
      const bool known = std::ranges::any_of(
          attitudes, [&](const Quat& other) { return other.angularDistance(q) < 1e-6; });
      if (!known && attitudes.size() < most_attitudes) attitudes.push_back(q);
    }
  }
  for (const Quat& q : attitudes) {
    axis.values.push_back(static_cast<double>(axis.values.size() + 1));
    axis.names.push_back(attitude_words(q));
    stage.states.push_back({{q}});
  }
  if (attitudes.size() > 1) stage.axes = {std::move(axis)};
  light_along(stage, run, attitudes);
  stage.remark = "The light of the nominal model at the attitudes of the sweeps.";
  page.stage = std::move(stage);
}

}  // namespace

void show_light(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                const OpticalRun* run, RunPage& page) {
  const std::vector<ScanGroup> scans = scan_groups(recordings);
  std::vector<RecordingSeries> runs, sweeps;
  for (const RecordingSeries& recording : recordings) {
    if (!recording.attitude.time_s.empty()) runs.push_back(recording);
    if (recording.light && !recording.light->voltage_V.empty()) sweeps.push_back(recording);
  }
  if (!scans.empty()) add_maps(scans, something_was_found, page);
  for (const RecordingSeries& sweep : sweeps) add_sweeps(sweep, something_was_found, page);
  const bool shows_runs = run != nullptr && scans.empty() && !runs.empty();
  for (size_t r = 0; r < runs.size(); ++r) {
    // The slider is over the first run alone.
    std::optional<PlotCursor> cursor;
    if (r == 0 && shows_runs) cursor.emplace();
    add_curves(runs[r], r == 0 ? "" : "_of_run_" + std::to_string(r + 1), cursor, page);
  }
  if (run == nullptr) return;
  if (!scans.empty()) {
    show_scans(scans, *run, something_was_found, page);
  } else if (shows_runs) {
    show_runs(runs, *run, something_was_found, page);
  } else if (!sweeps.empty()) {
    show_attitudes(sweeps, *run, page);
  }
}

}  // namespace photorque
