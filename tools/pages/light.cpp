#include "tools/pages/parts.h"

#include <algorithm>
#include <memory>
#include <set>

#include "core/files.h"
#include "receivers/wrench/table_product.h"
#include "tools/sweeps/labels.h"

namespace photorque {
namespace {

PageFigure figure_of(const Quantity& quantity) {
  const AxisLabel label = label_of_figure(quantity.name);
  return {quantity.name, label.name, label.unit, quantity.estimate};
}

// Stages from the rows "stage", "lost_to", "power_W", "lost_W": the remaining power after each
// loss.
std::vector<PowerStage> stages_of_array(const Table& losses) {
  std::vector<PowerStage> stages;
  const auto& left_W = losses.column("power_W").values;
  for (size_t i = 0; i < left_W.size(); ++i) {
    if (i == 0) {
      stages.push_back({losses.column("stage").texts[i], {left_W[i], 0.0}, true});
    } else {
      stages.push_back(
          {losses.column("lost_to").texts[i], {losses.column("lost_W").values[i], 0.0}});
    }
  }
  if (left_W.size() > 1) {
    stages.push_back({losses.column("stage").texts.back(), {left_W.back(), 0.0}, true});
  }
  return stages;
}

// Instances with a flux map.
std::set<uint32_t> measured(const Experiment& experiment) {
  std::set<uint32_t> instances;
  for (const NamedReceiver& receiver : experiment.receivers) {
    if (!receiver.flux_map) continue;
    const auto& of = receiver.flux_map->grid().instances;
    instances.insert(of.begin(), of.end());
  }
  return instances;
}

std::vector<PowerStage> stages_of_light(const OpticalRun& run, const OpticalResult& light) {
  const PowerBalance& balance = light.power_balance;
  const Scene& scene = run.experiment().scene;
  const std::vector<std::string>& names = run.wrench().part_names();
  const std::set<uint32_t> wanted = measured(run.experiment());
  std::vector<PowerStage> stages = {{"emitted by the lamps", {balance.emitted_W, 0.0}, true}};
  std::vector<PowerStage> losses, kept;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Estimate& absorbed_W = balance.absorbed_by_instance_W[i];
    if (!(absorbed_W.value > 0.0)) continue;
    auto& to = wanted.contains(static_cast<uint32_t>(i)) ? kept : losses;
    to.push_back({"absorbed by " + names[i], absorbed_W});
  }
  std::ranges::stable_sort(losses, std::greater{}, [](const auto& s) { return s.power_W.value; });
  constexpr size_t single = 8;  // number of parts with a separate line
  if (losses.size() > single + 1) {
    double rest_W = 0.0, variance = 0.0;
    for (size_t i = single; i < losses.size(); ++i) {
      rest_W += losses[i].power_W.value;
      variance += losses[i].power_W.standard_error * losses[i].power_W.standard_error;
    }
    const std::string label =
        "absorbed by " + std::to_string(losses.size() - single) + " other parts";
    losses.resize(single);
    losses.push_back({label, {rest_W, std::sqrt(variance)}});
  }
  stages.push_back({"passes the scene or leaves it again", balance.escaped_W});
  stages.insert(stages.end(), losses.begin(), losses.end());
  if (balance.truncated_W.value > 1e-9 * balance.emitted_W) {
    stages.push_back({"no longer followed", balance.truncated_W});
  }
  for (PowerStage& stage : kept) stage.is_total = true;
  if (kept.size() == 1) {
    stages.push_back(kept.front());
  } else {
    // Several measured parts are losses of the remaining power as well, not a single end.
    for (PowerStage& stage : kept) stage.is_total = false;
    stages.insert(stages.end(), kept.begin(), kept.end());
  }
  return stages;
}

void add_node(SceneStage& stage, const TracedNode& node) {
  const Experiment& experiment = node.run.experiment();
  const bool is_first = stage.states.empty();
  if (is_first) stage = stage_of(node.run, StageMaps::own);
  StageState state = lit_state(node.run, node.lab_from_body, node.light);
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    const auto& map = experiment.receivers[i].flux_map;
    if (!map) continue;
    if (is_first) stage.figures.push_back({"light on " + experiment.receivers[i].name, "W"});
    state.figures.push_back(map->flux_map(node.light.sums[i]).incident.power_W);
  }
  if (node.electric_W) {
    if (is_first) stage.figures.push_back({"electric power", "W"});
    state.figures.push_back(*node.electric_W);
  }
  stage.states.push_back(std::move(state));
  add_light(stage, node.run, node.lab_from_body, node.light, node.nodes);
}

StageAxis axis_of(const std::string& name, const std::vector<double>& angles_rad) {
  StageAxis axis{name, "deg", {}};
  for (const double angle_rad : angles_rad) axis.values.push_back(stated_deg(angle_rad));
  return axis;
}

}  // namespace

RunPage page_of(const RunResult& result, const PageHead& head,
                const std::vector<std::string>& headlines) {
  constexpr size_t most_headlines = 6;
  RunPage page;
  page.title = head.title;
  page.verb = head.verb;
  page.command = head.command;
  for (const Quantity& quantity : result.product.quantities) {
    page.figures.push_back(figure_of(quantity));
  }
  for (const std::string& wanted : headlines) {
    for (const PageFigure& figure : page.figures) {
      if (page.headlines.size() == most_headlines) break;
      if (figure.key.starts_with(wanted)) page.headlines.push_back(figure);
    }
  }
  page.product = result.product;
  page.provenance = result.provenance;
  page.rays = result.cost.rays;
  return page;
}

RunFile page_file(RunPage page) {
  const auto shared = std::make_shared<const RunPage>(std::move(page));
  return {
      "page.html",
      [shared](const std::filesystem::path& path) { write_file_whole(path, page_html(*shared)); },
      "interactive page of the run"};
}

RunFile light_page(const OpticalRun& run, const OpticalResult& light, const RunResult& result,
                   const PageHead& head) {
  const std::vector<std::string> of_trace = {"emitted_W", "power_on_", "absorbed_W", "escaped_W"};
  const std::vector<std::string> of_power = {"array_power_W",
                                             "emitted_W",
                                             "power_on_cells_W",
                                             "array_efficiency",
                                             "light_to_electric_efficiency",
                                             "cell_temperature_K",
                                             "array_power_slope_W_K"};
  RunPage page = page_of(result, head, head.verb == "power" ? of_power : of_trace);
  const Experiment& experiment = run.experiment();
  page.headline = "Tilt " + show(stated_deg(experiment.file.attitude.tilt_rad)) + " deg, heading " +
                  show(stated_deg(experiment.file.attitude.heading_rad)) + " deg. " +
                  std::to_string(experiment.beams.size()) +
                  (experiment.beams.size() == 1 ? " lamp, " : " lamps, ") +
                  std::to_string(experiment.scene.instances.size()) + " parts.";
  const Table* losses = find_table(result.product, "losses");
  page.power = losses != nullptr ? stages_of_array(*losses) : stages_of_light(run, light);
  // The waterfall of page.power replaces this plot.
  std::erase_if(page.product.plots, [](const Plot& plot) { return plot.name == "loss_waterfall"; });
  page.notes = experiment.notices;
  page.stage = stage_of(run, StageMaps::of_product);
  page.stage->states.push_back(lit_state(run, experiment.lab_from_body, light));
  add_light(*page.stage, run, experiment.lab_from_body, light, 1);
  return page_file(std::move(page));
}

NodeWatch add_to(SceneStage& stage) {
  return [&stage](const TracedNode& node) { add_node(stage, node); };
}

RunFile torque_map_page(const OpticalRun& run, const WrenchTable& table, const RunResult& result,
                        SceneStage stage, const PageHead& head) {
  RunPage page = page_of(result, head, {"largest_", "max_"});
  // Maps of the torque, the main result, come first.
  std::ranges::stable_partition(page.product.maps,
                                [](const Map& map) { return map.title.starts_with("Torque"); });
  const bool by_tilt = table.angles == WrenchTable::Angles::tilt_heading;
  page.stage = std::move(stage);
  page.stage->axes = {axis_of(by_tilt ? "tilt" : "elevation", table.polar_rad),
                      axis_of(by_tilt ? "heading" : "azimuth", table.around_rad)};
  const std::string first = page.stage->axes[0].name + " [deg]";
  for (const Plot& plot : result.product.plots) {
    if (plot.x_label == first) page.cursors.push_back({plot.name, 0, 1.0});
  }
  page.headline = std::to_string(table.nodes()) +
                  (by_tilt ? " attitudes" : " directions of light, in body axes") +
                  "; force and torque in body axes about the centre of rotation.";
  page.notes = run.experiment().notices;
  return page_file(std::move(page));
}

}  // namespace photorque
