#include "tools/pages/torque_map.h"

#include <algorithm>

#include "receivers/wrench/table_product.h"
#include "tools/pages/stage.h"

namespace photorque {
namespace {

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

TorqueMapStage::TorqueMapStage() : stage_(std::make_unique<SceneStage>()) {}

NodeWatch TorqueMapStage::watch() {
  return [stage = stage_.get()](const TracedNode& node) { add_node(*stage, node); };
}

RunFile torque_map_page(const OpticalRun& run, const WrenchTable& table, const RunResult& result,
                        TorqueMapStage stage, const PageHead& head) {
  RunPage page = page_of(result, head.title, head.verb, head.command, {"largest_", "max_"});
  // The torque is what the map is made for: the first that is shown.
  std::ranges::stable_partition(page.product.maps,
                                [](const Map& map) { return map.title.starts_with("Torque"); });
  const bool by_tilt = table.angles == WrenchTable::Angles::tilt_heading;
  page.stage = stage.take();
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
