// photorque propagate: propagates the platform through its disturbances.
#include "tools/tasks/propagate.h"

#include "tools/commands/page.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/pages/pages.h"

namespace photorque::kinds::propagate {
namespace {

void run_propagate(const CommandLine& line) {
  const Console console = terminal(line);
  std::optional<CheckpointFile> checkpoint;
  if (line.checkpoint_min) {
    checkpoint.emplace(line.out_folder() / "propagate.checkpoint", 60.0 * *line.checkpoint_min);
  }
  MotionRun run = propagate_experiment(line, console, {}, {}, checkpoint ? &*checkpoint : nullptr);
  if (line.page) run.result.files.push_back(motion_page(run, line, page_head(line)));
  write_results(line, console, run.result);
  // Its work is done and stands in the results.
  std::error_code stays;
  if (checkpoint) std::filesystem::remove(checkpoint->path(), stays);
}

}  // namespace

Verb kind() {
  Verb verb{"propagate", "Fly the platform: attitude, rates, charge, every torque; a recording",
            run_propagate};
  verb.takes_checkpoint = true;
  verb.draws_page = true;
  return verb;
}

}  // namespace photorque::kinds::propagate
