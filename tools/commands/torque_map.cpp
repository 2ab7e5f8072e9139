// photorque torque-map: force, torque and power over a grid of attitudes.
#include "tools/tasks/torque_map.h"

#include "tools/commands/page.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/pages/torque_map.h"

namespace photorque {
namespace {

void run_torque_map(const CommandLine& line) {
  const Console console = terminal(line);
  if (!line.page) {
    write_results(line, console, torque_map_of_experiment(line, console).result);
    return;
  }
  TorqueMapStage stage;
  TorqueMapRun run = torque_map_of_experiment(line, console, stage.watch());
  run.result.files.push_back(torque_map_page(run, std::move(stage), page_head(line)));
  write_results(line, console, run.result);
}

}  // namespace

Verb torque_map_verb() {
  Verb verb{"torque-map", "Force, torque and power over a grid of attitudes or directions of light",
            run_torque_map, true};
  verb.draws_page = true;
  return verb;
}

}  // namespace photorque
