// photorque power: trace, then the solar array.
#include "tools/runs/array_power.h"
#include "tools/runs/array_report.h"
#include "tools/runs/published.h"

namespace photorque {
namespace {

void run_power(const CommandLine& line) {
  Console console(line);
  OpticalRun run(line, console);
  const ArrayPower array = read_array_power(run);
  for (const std::string& notice : array.notices) console.line("note: " + notice);
  const OpticalResult result = run.run(run.experiment().lab_from_body, console.progress("tracing"));
  console.done();
  const ArrayResult power = evaluate(array, run, result);
  print_trace(console, run, result);
  print_array(console, power, result);
  Product product = run.product(result);
  append(product, array_power_product(power, result));
  append(product, report_array(console, run, array, result, power));
  Table table = compare_published(array.report.published, run.experiment().file.attitude.tilt_rad,
                                  product, console);
  if (!table.columns.empty()) product.tables.push_back(std::move(table));
  write_results(line, console, product, run.provenance(result), result.rays, result.wall_s);
}

}  // namespace

Verb power_verb() {
  return {"power", "Trace, then the solar array: current-voltage curve and maximum power point",
          run_power, true};
}

}  // namespace photorque
