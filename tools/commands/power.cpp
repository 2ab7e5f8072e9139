// photorque power: trace, then the solar array.
#include "tools/tasks/power.h"

#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque {
namespace {

void run_power(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, power_of_experiment(line, console).result);
}

}  // namespace

Verb power_verb() {
  return {"power", "Trace, then the solar array: current-voltage curve and maximum power point",
          run_power, true};
}

}  // namespace photorque
