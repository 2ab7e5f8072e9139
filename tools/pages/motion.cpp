#include "tools/pages/parts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constants.h"
#include "scenes/experiment/experiment.h"
#include "tools/coupling/propagate.h"

namespace photorque {
namespace {

constexpr size_t most_states = 2000;

// Value of a column at the row nearest to a time.
double at_time(const Table& table, const std::vector<double>& values, double time_s) {
  return values[nearest_instant(table.column("t_s").values, time_s)];
}

// Columns stem_x_N_m, stem_y_N_m, stem_z_N_m of the torque with this stem; without a stem those of
// all torques.
std::vector<const std::vector<double>*> torque_columns(const Table& history, char axis,
                                                       const std::string& wanted) {
  const std::string end = std::string("_") + axis + "_N_m";
  std::vector<const std::vector<double>*> columns;
  for (const Table::Column& column : history.columns) {
    if (!column.name.starts_with("torque_") || !column.name.ends_with(end)) continue;
    if (wanted.empty() || column.name == wanted + end) columns.push_back(&column.values);
  }
  return columns;
}

Vec3 torque_at(const Table& history, const std::string& wanted, double time_s) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    for (const auto* values : torque_columns(history, "xyz"[k], wanted)) {
      sum[k] += at_time(history, *values, time_s);
    }
  }
  return sum;
}

// A figure beside the stage: a column of a table of the run.
struct Shown {
  StageFigure figure;
  const Table* table;
  const std::vector<double>* values;
};

std::vector<Shown> shown_figures(const Product& product) {
  const Table* history = find_table(product, "time_history");
  const Table* power = find_table(product, "power");
  std::vector<Shown> shown;
  const auto add = [&](const char* label, const char* unit, const Table* table, const char* name) {
    const Table::Column* const column = table == nullptr ? nullptr : table->find(name);
    if (column != nullptr) shown.push_back({{label, unit}, table, &column->values});
  };
  add("tilt", "deg", history, "tilt_deg");
  add("yaw", "deg", history, "yaw_deg");
  for (const char* axis : {"x", "y", "z"}) {
    add((std::string("rate about body ") + axis).c_str(), "rad/s", history,
        (std::string("rate_") + axis + "_rad_s").c_str());
  }
  add("light on the cells", "W", power, "light_on_cells_W");
  add("array power", "W", power, "array_power_W");
  add("load served", "W", power, "load_power_W");
  add("battery", "Wh", power, "battery_charge_Wh");
  if (power == nullptr) add("charge drawn", "Ah", history, "charge_drawn_Ah");
  return shown;
}

// Largest rotation angle between two consecutive states.
double largest_turn_rad(const std::vector<PlatformState>& states) {
  double largest = 0.0;
  for (size_t i = 1; i < states.size(); ++i) {
    largest =
        std::max(largest, states[i].lab_from_body.angularDistance(states[i - 1].lab_from_body));
  }
  return largest;
}

// Half-axes of the ellipsoid in body axes: each column is a direction times a length; the longest
// is 0.5 m.
Mat3 half_axes_m(const Platform& platform) {
  if (platform.turns_about_one_axis()) {
    return 0.5 * (Mat3::Identity() - 0.9 * platform.axis * platform.axis.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(platform.inertia_kg_m2);
  const Vec3& moments = solver.eigenvalues();
  // A uniform ellipsoid of mass m has I1 = m (b² + c²)/5 and so on, so that a² is proportional to
  // I2 + I3 − I1.
  Vec3 lengths;
  for (int k = 0; k < 3; ++k) {
    lengths[k] = std::sqrt(std::max(0.0, 0.5 * moments.sum() - moments[k]));
  }
  const double longest = lengths.maxCoeff();
  // A body without extent along an axis is drawn as a thin one.
  lengths = lengths.cwiseMax(0.04 * longest) * (0.5 / longest);
  return solver.eigenvectors() * lengths.asDiagonal();
}

StagePart ellipsoid(const Mat3& axes_m) {
  constexpr int around = 36, along = 18;
  StagePart part{"platform", {0.72, 0.74, 0.77}, {}, {}};
  for (int i = 0; i <= along; ++i) {
    for (int j = 0; j < around; ++j) {
      const double polar = pi * i / along, turn = 2.0 * pi * j / around;
      const Vec3 at = axes_m * Vec3(std::sin(polar) * std::cos(turn),
                                    std::sin(polar) * std::sin(turn), std::cos(polar));
      for (int k = 0; k < 3; ++k) part.position_m.push_back(static_cast<float>(at[k]));
    }
  }
  const auto vertex = [](int i, int j) { return static_cast<uint32_t>(i * around + j % around); };
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) {
      part.triangles.insert(part.triangles.end(),
                            {vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      part.triangles.insert(part.triangles.end(),
                            {vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j + 1)});
    }
  }
  return part;
}

// A square rod from the origin along x.
StagePart rod_along_x(double length_m) {
  const auto l = static_cast<float>(length_m);
  const auto w = static_cast<float>(0.02);
  StagePart rod{"body x", {0.30, 0.33, 0.37}, {}, {}};
  for (const float x : {0.0f, l}) {
    for (const float y : {-w, w}) {
      for (const float z : {-w, w}) rod.position_m.insert(rod.position_m.end(), {x, y, z});
    }
  }
  rod.triangles = {0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7, 0, 4, 1, 1, 4, 5,
                   2, 3, 6, 3, 7, 6, 0, 2, 4, 2, 6, 4, 1, 5, 3, 3, 5, 7};
  return rod;
}

}  // namespace

RunFile motion_page(const MotionRun& run, const RunOptions& options, const PageHead& head) {
  RunPage page = page_of(run.result, head,
                         {"largest_tilt_deg", "final_yaw_deg", "final_rate_rad_s",
                          "mean_array_power_W", "load_unserved_Wh", "battery_left_Wh"});
  std::optional<OpticalRun> light;  // of an experiment with a scene
  if (run.coupled->light) light.emplace(options, Console());
  SceneStage stage =
      light ? stage_of(*light, StageMaps::own) : platform_stage(run.run->model.platform);
  std::vector<PlatformState> states;
  for (const size_t i : even_indices(run.coupled->motion.states.size(), most_states)) {
    states.push_back(run.coupled->motion.states[i]);
  }
  const Table* history = find_table(run.result.product, "time_history");
  const bool has_torques = history != nullptr && !torque_columns(*history, 'x', "").empty();
  const bool has_light =
      history != nullptr && !torque_columns(*history, 'x', "torque_radiation_pressure").empty();
  stage.arrows.clear();
  if (has_torques) stage.arrows.push_back({"all torques", "N m", StageArrow::Kind::torque});
  if (has_light) stage.arrows.push_back({"torque of light", "N m", StageArrow::Kind::torque});
  const std::vector<Shown> figures = shown_figures(run.result.product);
  for (const Shown& shown : figures) stage.figures.push_back(shown.figure);
  StageAxis time{"time", "s", {}, true};
  for (const PlatformState& state : states) {
    StageState at{{state.lab_from_body}};
    if (has_torques) at.arrow_body.push_back(torque_at(*history, "", state.time_s));
    if (has_light)
      at.arrow_body.push_back(torque_at(*history, "torque_radiation_pressure", state.time_s));
    at.arrow_error_body.assign(at.arrow_body.size(), Vec3::Zero());
    for (const Shown& shown : figures) {
      at.figures.push_back({at_time(*shown.table, *shown.values, state.time_s), 0.0});
    }
    time.values.push_back(state.time_s);
    stage.states.push_back(std::move(at));
  }
  stage.axes = {std::move(time)};
  if (light) {
    std::vector<Quat> attitudes;
    for (const PlatformState& state : states) attitudes.push_back(state.lab_from_body);
    light_along(stage, *light, attitudes);
  }
  if (const double turn_rad = largest_turn_rad(states); turn_rad > 0.5 * pi) {
    add_sentence(stage.remark, "Between two instants of this page the body turns by up to " +
                                   show(std::round(turn_rad / degree_rad)) +
                                   " deg: the rotation between them is not shown.");
  }
  page.stage = std::move(stage);
  for (const Plot& plot : run.result.product.plots) {
    if (plot.x_label == "time [s]") page.cursors.push_back({plot.name, 0, 1.0});
  }
  // Pages do not show area plots.
  std::erase_if(page.product.plots,
                [](const Plot& plot) { return plot.name == "torque_fractions"; });
  // The plot with all curves over a common time axis comes first.
  std::ranges::stable_partition(page.product.plots,
                                [](const Plot& plot) { return plot.name == "power_and_attitude"; });
  page.headline = show(states.back().time_s - states.front().time_s) + " s, " +
                  std::to_string(run.run->model.disturbances.size()) + " disturbances.";
  return page_file(std::move(page));
}

SceneStage platform_stage(const Platform& platform) {
  SceneStage stage;
  const Mat3 axes_m = half_axes_m(platform);
  // Extent of the ellipsoid along x, plus a margin.
  stage.parts = {ellipsoid(axes_m), rod_along_x(axes_m.row(0).norm() + 0.15)};
  stage.radius_m = 0.6;
  const Camera camera = camera_framing(stage.radius_m);
  stage.camera = {camera.position_m, camera.target_m, camera.field_of_view_rad / degree_rad};
  stage.remark = platform.turns_about_one_axis()
                     ? "The experiment names no scene: a disc about its axis stands for the "
                       "platform; the rod is along body x."
                     : "The experiment names no scene: an ellipsoid with the proportions of the "
                       "platform's moments of inertia stands for it; the rod is along body x.";
  return stage;
}

}  // namespace photorque
