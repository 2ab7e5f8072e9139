// photorque trace: irradiance on every receiver, power balance, radiation wrench.
#include "tools/tasks/trace.h"

#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque {
namespace {

void run_trace(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, trace_experiment(line, console, !line.take_result).result);
}

}  // namespace

Verb trace_verb() {
  return {"trace", "Irradiance on every receiver, where the power went, radiation force and torque",
          run_trace, true};
}

}  // namespace photorque
