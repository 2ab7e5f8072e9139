// photorque torque-map: force, torque and power over a grid of attitudes.
#include "tools/tasks/torque_map.h"

#include "tools/commands/page.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/pages/pages.h"

namespace photorque::kinds::torque_map {
namespace {

void run_torque_map(const CommandLine& line) {
  const Console console = terminal(line);
  std::optional<CheckpointFile> checkpoint;
  if (line.checkpoint_min) {
    checkpoint.emplace(line.out_folder() / "torque-map.checkpoint", 60.0 * *line.checkpoint_min);
  }
  CheckpointFile* file = checkpoint ? &*checkpoint : nullptr;
  TorqueMapStage stage;
  const NodeWatch watch = line.page ? stage.watch() : NodeWatch{};
  TorqueMapRun run = torque_map_of_experiment(line, console, watch, file);
  if (line.page) {
    run.result.files.push_back(torque_map_page(run, std::move(stage), page_head(line)));
  }
  write_results(line, console, run.result);
  // Its work is done and stands in the results.
  std::error_code stays;
  if (checkpoint) std::filesystem::remove(checkpoint->path(), stays);
}

}  // namespace

Verb kind() {
  Verb verb{"torque-map", "Force, torque and power over a grid of attitudes or directions of light",
            run_torque_map, true};
  verb.takes_checkpoint = true;
  verb.draws_page = true;
  return verb;
}

}  // namespace photorque::kinds::torque_map
