// photorque propagate: motion of the platform under its disturbances.
#include "tools/coupling/propagate.h"

#include "tools/pages/pages.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::propagate {
namespace {

void add_options(Command& command, CommandOptions& options) {
  command.add_experiment(options);
  command.add_checkpoint(options);
  command.add_page(options);
}

void run(const CommandOptions& options, const Program&) {
  const Console console = terminal(options);
  const std::unique_ptr<CheckpointFile> checkpoint = checkpoint_of(options);
  MotionRun run = run_propagate(options, console, {}, {}, checkpoint.get());
  if (options.page) run.result.files.push_back(motion_page(run, options, page_head(options)));
  write_results(options, console, run.result);
  if (checkpoint) checkpoint->remove();
}

}  // namespace

Verb kind() {
  return {"propagate",
          "Motion of the platform under its disturbances: attitude, rates, torques, and a "
          "simulated recording",
          command_with(add_options, run),
          {"platform", "environment", "disturbance", "sensors", "propagate", "light", "array"},
          "[platform]",
          [](const RunOptions& options) { return run_propagate(options, Console()).result; }};
}

}  // namespace photorque::verbs::propagate
