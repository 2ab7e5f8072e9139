#include "tools/pages/runs.h"

#include "receivers/wrench/table_product.h"
#include "tools/pages/stage.h"

namespace photorque {
namespace {

// One attitude, traced.
RunPage lit_page(const OpticalRun& run, const OpticalResult& light, const RunResult& result,
                 const PageHead& head, const std::vector<std::string>& headlines) {
  RunPage page = page_of(result, head.title, head.verb, head.command, headlines);
  const Experiment& experiment = run.experiment();
  page.headline = "Tilt " + show(stated_deg(experiment.file.attitude.tilt_rad)) + " deg, heading " +
                  show(stated_deg(experiment.file.attitude.heading_rad)) + " deg. " +
                  std::to_string(experiment.beams.size()) +
                  (experiment.beams.size() == 1 ? " lamp, " : " lamps, ") +
                  std::to_string(experiment.scene.instances.size()) + " parts.";
  page.power = power_stages(run, light, result.product);
  // The same as bars.
  std::erase_if(page.product.plots, [](const Plot& plot) { return plot.name == "loss_waterfall"; });
  page.notes = experiment.notices;
  page.stage = stage_of(run, StageMaps::of_product);
  page.stage->states.push_back(lit_state(run, experiment.lab_from_body, light));
  add_light(*page.stage, run, experiment.lab_from_body, light, 1);
  return page;
}

}  // namespace

RunFile light_page(const OpticalRun& run, const OpticalResult& light, const RunResult& result,
                   const PageHead& head) {
  const std::vector<std::string> of_trace = {"emitted_W", "power_on_", "absorbed_W", "escaped_W"};
  const std::vector<std::string> of_power = {"array_power_W", "emitted_W", "power_on_cells_W",
                                             "array_efficiency", "light_to_electric_efficiency"};
  return page_file(lit_page(run, light, result, head, head.verb == "power" ? of_power : of_trace));
}

}  // namespace photorque
