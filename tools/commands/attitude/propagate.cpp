// photorque propagate: propagates the platform through its disturbances.
#include "tools/tasks/propagate.h"

#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque {
namespace {

void run_propagate(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, propagate_experiment(line, console).result);
}

}  // namespace

Verb propagate_verb() {
  return {"propagate", "Fly the platform: attitude, rates, charge, every torque; a recording",
          run_propagate};
}

}  // namespace photorque
