// photorque trace: irradiance on every receiver, power ledger, radiation wrench.
#include "tools/optical_run.h"
#include "tools/published.h"

namespace photorque {
namespace {

void run_trace(const CommandLine& line) {
  Console console(line);
  const OpticalRun run(line, console);
  const auto published = read_published(run.experiment().file.others("published"));
  const OpticalResult result = run.run(run.experiment().lab_from_body, console.progress("tracing"));
  console.done();
  print_trace(console, run, result);
  Product product = run.product(result);
  Table table =
      compare_published(published, run.experiment().file.attitude.tilt_rad, product, console);
  if (!table.columns.empty()) product.tables.push_back(std::move(table));
  write_results(line, console, product, run.provenance(), result.rays, result.wall_s);
}

}  // namespace

Verb trace_verb() {
  return {"trace", "Irradiance on every receiver, where the power went, radiation force and torque",
          run_trace, true};
}

}  // namespace photorque
