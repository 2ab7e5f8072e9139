// photorque propagate: propagates the platform through its disturbances.
#include "tools/coupling/propagate.h"

#include "tools/pages/pages.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::propagate {
namespace {

struct Options : CommandOptions {
  std::optional<double> checkpoint_min;
};

void add_options(Command& command, Options& options) {
  command.add_experiment(options);
  command.add_checkpoint(options.checkpoint_min);
  command.add_page(options);
}

void run(const Options& options, const Program&) {
  const Console console = terminal(options);
  std::optional<CheckpointFile> checkpoint;
  if (options.checkpoint_min) {
    checkpoint.emplace(options.out_folder() / "propagate.checkpoint",
                       60.0 * *options.checkpoint_min);
  }
  MotionRun run = run_propagate(options, console, {}, {}, checkpoint ? &*checkpoint : nullptr);
  if (options.page) run.result.files.push_back(motion_page(run, options, page_head(options)));
  write_results(options, console, run.result);
  // The results are complete, so that the checkpoint is not needed.
  std::error_code stays;
  if (checkpoint) std::filesystem::remove(checkpoint->path(), stays);
}

}  // namespace

Verb kind() {
  return {"propagate",
          "Motion of the platform: attitude, rates, charge, every torque, a recording",
          command_with(add_options, run),
          {"platform", "environment", "disturbance", "sensors", "propagate", "light", "array"},
          "[platform]",
          [](const RunOptions& options) { return run_propagate(options, Console()).result; }};
}

}  // namespace photorque::verbs::propagate
