// photorque torque-map: force, torque and power over a grid of attitudes, or wrench over directions
// of light.
#include "tools/verbs/torque_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "receivers/wrench/table_product.h"
#include "tools/coupling/direction_map.h"
#include "tools/pages/pages.h"
#include "tools/runs/array_power.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

// A cell of the printed table, preceded by at least three blanks.
std::string in_column(const std::string& text) {
  const size_t width = 28, shown = letters_of(text);
  return std::string(3, ' ') + text + std::string(shown < width ? width - shown : 0, ' ');
}

// Power over the attitudes, one row per node in the order of the wrench table.
class PowerTable {
 public:
  void add(double tilt_rad, double heading_rad, const Estimate& light,
           const std::optional<ArrayResult>& array) {
    Table::Row row = table_.row();
    row.set("tilt_deg", stated_deg(tilt_rad)).set("heading_deg", stated_deg(heading_rad));
    row.set("on_receiver_W", light.value).set("on_receiver_error_W", light.standard_error);
    if (!array) return;
    row.set("electric_W", array->power_W.value)
        .set("electric_error_W", array->power_W.standard_error)
        .set("cell_temperature_K", array->temperature_K.value);
  }
  const Table& table() const { return table_; }

  // Curves over the tilt, one per heading, of the columns `stem`_W and `stem`_error_W.
  Plot plot(size_t headings, size_t tilts, const std::string& stem, const std::string& name,
            const std::string& title) const {
    const auto& power_W = table_.column(stem + "_W").values;
    const auto& error_W = table_.column(stem + "_error_W").values;
    Plot plot{name, title, "tilt [deg]", "power [W]"};
    for (size_t h = 0; h < headings; ++h) {
      Plot::Curve curve;
      for (size_t t = 0; t < tilts; ++t) {
        const size_t row = h * tilts + t;
        curve.x.push_back(table_.column("tilt_deg").values[row]);
        curve.y.push_back(power_W[row]);
        curve.y_error.push_back(error_W[row]);
      }
      curve.label = "heading " + show(table_.column("heading_deg").values[h * tilts]) + " deg";
      plot.curves.push_back(std::move(curve));
    }
    return plot;
  }

 private:
  Table table_ = Table::of("power_over_attitude", "Power over tilt and heading");
};

void print_torques(const WrenchTable& wrenches, const AttitudeGrid& grid, const Console& console) {
  constexpr size_t max_lines = 20;  // without --verbose
  console.heading("Torque about the centre of rotation, body frame");
  std::string names = "  tilt [deg]  heading [deg]";
  for (const char* name : {"torque x", "torque y", "torque z"}) names += in_column(name);
  console.line(names);
  size_t node_count = 0;
  double largest_N_m = 0.0;
  for (const Vec3& torque : wrenches.torque_body_N_m) {
    largest_N_m = std::max(largest_N_m, torque.cwiseAbs().maxCoeff());
  }
  // If all torques cancel, only rounding errors remain; they are printed as zero.
  const auto rounded_N_m = [&](double x) { return std::abs(x) < 1e-13 * largest_N_m ? 0.0 : x; };
  for (size_t h = 0; h < grid.heading_rad.size(); ++h) {
    for (size_t t = 0; t < grid.tilt_rad.size(); ++t) {
      const size_t node = wrenches.node(h, t);
      std::string line =
          printed("  %10g  %13g", grid.tilt_rad[t] / degree_rad, grid.heading_rad[h] / degree_rad);
      for (int i = 0; i < 3; ++i) {
        line += in_column(show(Estimate{rounded_N_m(wrenches.torque_body_N_m[node][i]),
                                        rounded_N_m(wrenches.torque_error_N_m[node][i])},
                               "N m"));
      }
      (node_count++ < max_lines ? console : console.details()).line(line);
    }
  }
  if (node_count > max_lines) {
    console.line("  " + std::to_string(node_count) +
                 " attitudes in all: wrench_table_body.csv, or --verbose");
  }
}

TorqueMapRun over_attitudes(const Console& console, const std::shared_ptr<OpticalRun>& shared,
                            const NodeWatch& watch) {
  OpticalRun& run = *shared;
  std::optional<ArrayPower> array;
  if (!run.experiment().file.others("array").empty()) array = read_array_power(run);
  if (array) {
    for (const std::string& notice : array->notices) console.line("note: " + notice);
  }
  const AttitudeGrid& grid = run.experiment().file.torque_map;
  if (!run.experiment().file.settings.has("torque_map")) {
    console.line("note: no [torque_map]: tilts to 30 deg towards eight headings");
  }
  const std::optional<size_t> flux_map = array ? array->flux_map : run.first_flux_map();

  WrenchTable wrenches =
      make_wrench_table(WrenchTable::Angles::tilt_heading, grid.tilt_rad, grid.heading_rad);
  PowerTable powers;
  uint64_t rays = 0;
  double wall_s = 0.0;
  Warnings warnings;
  const auto progress = console.progress("attitudes");
  for (size_t h = 0; h < grid.heading_rad.size(); ++h) {
    for (size_t t = 0; t < grid.tilt_rad.size(); ++t) {
      const size_t node = wrenches.node(h, t);
      // One seed for all attitudes: the sampling errors of neighbouring attitudes are correlated,
      // so that their differences are more accurate than their values.
      const RigidTransform lab_from_body = lab_from_body_at(grid.tilt_rad[t], grid.heading_rad[h]);
      const OpticalResult result =
          run.run(lab_from_body, {}, run.experiment().file.torque_map_rays);
      set_node(wrenches, node, run.wrench().total(result.sums[run.wrench_index()]));
      std::optional<ArrayResult> electric;
      if (array) electric = evaluate(*array, run, result);
      if (flux_map) {
        powers.add(grid.tilt_rad[t], grid.heading_rad[h],
                   run.flux_map(*flux_map).flux_map(result.sums[*flux_map]).incident.power_W,
                   electric);
      }
      warnings.add(run.warnings(result), "tilt " + show(stated_deg(grid.tilt_rad[t])) +
                                             " deg, heading " +
                                             show(stated_deg(grid.heading_rad[h])) + " deg");
      if (watch) {
        watch({run, wrenches.nodes(), lab_from_body, result,
               electric ? std::optional(electric->power_W) : std::nullopt});
      }
      rays += result.rays;
      wall_s += result.wall_s;
      if (progress) progress(static_cast<double>(node + 1) / static_cast<double>(wrenches.nodes()));
    }
  }
  console.done();

  Product product = wrench_table_product(wrenches, "body");
  if (flux_map) {
    product.tables.push_back(powers.table());
    product.plots.push_back(powers.plot(grid.heading_rad.size(), grid.tilt_rad.size(),
                                        "on_receiver", "power_on_receiver_over_tilt",
                                        "Light on " + run.experiment().receivers[*flux_map].name));
  }
  if (array) {
    product.plots.push_back(powers.plot(grid.heading_rad.size(), grid.tilt_rad.size(), "electric",
                                        "electric_power_over_tilt", "Electric power of the array"));
  }
  print_torques(wrenches, grid, console);
  if (array) {
    const auto [coldest_K, warmest_K] =
        std::ranges::minmax(powers.table().column("cell_temperature_K").values);
    console.line("  electric_W of the table: cells of " + show_temperature(coldest_K) + " to " +
                 show_temperature(warmest_K) + ", " + origin_of_temperature(array->design));
  }
  warnings.print(console);
  return {shared,
          std::move(wrenches),
          {std::move(product), warnings.into(run.provenance()), {wall_s, rays}}};
}

}  // namespace

TorqueMapRun run_torque_map(const RunOptions& options, const Console& console,
                            const NodeWatch& watch, CheckpointFile* checkpoint) {
  RunOptions own = options;
  const ExperimentFile file =
      read_experiment_text(options.experiment, options.experiment_text(), options.all_overrides());
  if (file.light_directions) own.threads = 1;
  if (watch && file.molecular_flow) {
    throw InputError({"--page"}, "", "a map of a gas flow", "directions of sunlight");
  }
  if (checkpoint != nullptr && !file.light_directions) {
    throw InputError({"--checkpoint"}, "", "a map over tilts",
                     "directions of sunlight ([torque_map] azimuth_step_deg, or azimuth_deg)");
  }
  const auto run = std::make_shared<OpticalRun>(own, console);
  if (!file.light_directions) return over_attitudes(console, run, watch);
  DirectionMap map = map_over_directions(console, *run, options.threads, watch, checkpoint);
  return {run, std::move(map.wrenches), std::move(map.result)};
}

}  // namespace photorque

namespace photorque::verbs::torque_map {
namespace {

void add_options(Command& command, CommandOptions& options) {
  command.add_traced_experiment(options);
  command.add_checkpoint(options);
  command.add_page(options);
}

void run(const CommandOptions& options, const Program&) {
  const Console console = terminal(options);
  const std::unique_ptr<CheckpointFile> checkpoint = checkpoint_of(options);
  SceneStage stage;
  const NodeWatch watch = options.page ? add_to(stage) : NodeWatch{};
  TorqueMapRun run = run_torque_map(options, console, watch, checkpoint.get());
  if (options.page) {
    run.result.files.push_back(
        torque_map_page(*run.run, run.wrenches, run.result, std::move(stage), page_head(options)));
  }
  write_results(options, console, run.result);
  if (checkpoint) checkpoint->remove();
}

}  // namespace

Verb kind() {
  return {"torque-map",
          "Force, torque and power over a grid of attitudes or directions of light",
          command_with(add_options, run),
          {"scene", "material", "source", "receiver", "joint", "attitude", "trace", "torque_map",
           "array"},
          "[scene] and [[source]]",
          [](const RunOptions& options) { return run_torque_map(options, Console()).result; }};
}

}  // namespace photorque::verbs::torque_map
