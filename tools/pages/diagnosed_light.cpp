#include <algorithm>
#include <cmath>

#include "raytrace/tracing/view.h"
#include "tools/pages/charts.h"
#include "tools/pages/parts.h"

namespace photorque {
namespace {

// Bins of the receiver, as small as the smallest of some scans.
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

// A map of a scan extended to the whole receiver; positions without a reading stay empty.
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

// Shows the scene with the scans painted on the receiver. Does nothing if the first receiver of
// light is not a plane.
void show_scans(const std::vector<ScanGroup>& groups, const OpticalRun& run, bool found,
                RunPage& page) {
  const size_t index = run.flux_map_index("");
  const SurfaceGrid& grid = run.flux_map(index).grid();
  if (grid.over != SurfaceGrid::Over::plane) return;
  SceneStage stage = stage_of(run, StageMaps::own);
  const PaintedSurface surface =
      *std::ranges::find(stage.paintings.front().surfaces, run.experiment().receivers[index].name,
                         &PaintedSurface::name);
  stage.paintings.clear();
  stage.arrows.clear();
  const PaintedBins bins = painted_bins(groups, grid);
  for (const ScanView& shown : views_of_scans(found)) {
    Painting painting{shown.title, "W/m²", shown.is_difference, {surface}};
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
  stage.remark = "The colours show the readings at their positions.";
  page.stage = std::move(stage);
}

// Shows the runs: the platform over time in the light of the nominal model, with the power of the
// array.
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
    if (found) stage.figures.push_back({"improved model", channel.unit});
  }
  for (const size_t i : even_indices(time_s.size(), most_states)) {
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

void add_sweeps(const RecordingSeries& recording, bool found, RunPage& page) {
  constexpr size_t most_sweeps = 24;  // per page
  for (const int sweep : sweeps_of(*recording.light)) {
    if (page.product.plots.size() == most_sweeps) {
      page.notes.push_back("More curves than " + std::to_string(most_sweeps) +
                           " were swept; the first of them are shown.");
      return;
    }
    page.product.plots.push_back(sweep_plot(recording, sweep, found));
  }
}

// Shows the scene at the attitudes of the sweeps, in the light of the nominal model.
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
    // The slider belongs to the first run only.
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
