// photorque propagate: propagates the platform through its disturbances.
#include "tools/tasks/propagate.h"

#include "tools/commands/page.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/pages/motion.h"

namespace photorque {
namespace {

void run_propagate(const CommandLine& line) {
  const Console console = terminal(line);
  MotionRun run = propagate_experiment(line, console);
  if (line.page) run.result.files.push_back(motion_page(run, line, page_head(line)));
  write_results(line, console, run.result);
}

}  // namespace

Verb propagate_verb() {
  Verb verb{"propagate", "Fly the platform: attitude, rates, charge, every torque; a recording",
            run_propagate};
  verb.draws_page = true;
  return verb;
}

}  // namespace photorque
