// photorque power: a trace, and the solar array's power from it.
#include "tools/verbs/power.h"

#include "tools/pages/pages.h"
#include "tools/runs/array_report.h"
#include "tools/runs/published.h"
#include "tools/verbs/verb.h"

namespace photorque {

PowerRun run_power(const RunOptions& options, const Console& console) {
  const auto run = std::make_shared<OpticalRun>(options, console);
  const Experiment& experiment = run->experiment();
  ArrayPower array = read_array_power(*run);
  for (const std::string& notice : array.notices) console.line("note: " + notice);
  OpticalResult light = run->run(experiment.lab_from_body, console.progress("tracing"));
  console.done();
  ArrayResult power = evaluate(array, *run, light);
  if (power.efficiency.value > 1.0) {
    run->warn(
        "the array delivers more than the light on its cells: the numbers of its diodes are "
        "those of no solar cell");
  }
  if (auto warning = above_rated(array.design, power.temperature_K.value)) {
    run->warn(std::move(*warning));
  }
  if (auto warning = above_absorbed(array, *run, light, power)) run->warn(std::move(*warning));
  print_trace(console, *run, light);
  print_array(console, array, power, light);
  Product product = run->product(light);
  append(product, array_power_product(array.design, power, light));
  append(product, report_array(console, *run, array, light, power));
  append(product, compare_published(array.report.published, experiment.file.attitude.tilt_rad,
                                    product, console));
  RunResult result{std::move(product), run->provenance(light), {light.wall_s, light.rays}};
  return {run, std::move(light), std::move(array), std::move(power), std::move(result)};
}

}  // namespace photorque

namespace photorque::verbs::power {
namespace {

RunResult run(const CommandOptions& options, const Console& console) {
  PowerRun run = run_power(options, console);
  if (options.page) {
    run.result.files.push_back(light_page(*run.run, run.light, run.result, page_head(options)));
  }
  return std::move(run.result);
}

}  // namespace

Verb kind() {
  return {"power",
          "Results of trace, and the solar array: current-voltage curve, maximum power point",
          command_that_writes(traced_page_options, run),
          {"scene", "material", "source", "receiver", "joint", "attitude", "trace", "array",
           "published", "effect", "environment", "disturbance"},
          "[array]",
          [](const RunOptions& options) { return run_power(options, Console()).result; }};
}

}  // namespace photorque::verbs::power
