#include "tools/tasks/power.h"

#include "tools/runs/array_report.h"
#include "tools/runs/published.h"

namespace photorque {

PowerRun power_of_experiment(const RunOptions& options, const Console& console) {
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
  print_trace(console, *run, light);
  print_array(console, power, light);
  Product product = run->product(light);
  append(product, array_power_product(power, light));
  append(product, report_array(console, *run, array, light, power));
  append(product, compare_published(array.report.published, experiment.file.attitude.tilt_rad,
                                    product, console));
  RunResult result{std::move(product), run->provenance(light), {light.wall_s, light.rays}};
  return {run, std::move(light), std::move(array), std::move(power), std::move(result)};
}

}  // namespace photorque
