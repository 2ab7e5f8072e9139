// photorque trace: irradiance on every receiver, power balance, radiation wrench.
#include "tools/commands/page.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/pages/pages.h"

namespace photorque::kinds::trace {
namespace {

void run_trace(const CommandLine& line) {
  const Console console = terminal(line);
  TraceRun run = trace_experiment(line, console, !line.take_result);
  if (line.page) run.result.files.push_back(trace_page(run, page_head(line)));
  write_results(line, console, run.result);
}

}  // namespace

Verb kind() {
  Verb verb{"trace",
            "Irradiance on every receiver, where the power went, radiation force and torque",
            run_trace, true};
  verb.draws_page = true;
  return verb;
}

}  // namespace photorque::kinds::trace
