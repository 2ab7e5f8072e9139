// photorque torque-map: force, torque and power over a grid of attitudes.
#include "tools/tasks/torque_map.h"

#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque {
namespace {

void run_torque_map(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, torque_map_of_experiment(line, console).result);
}

}  // namespace

Verb torque_map_verb() {
  return {"torque-map", "Force, torque and power over a grid of attitudes or directions of light",
          run_torque_map, true};
}

}  // namespace photorque
