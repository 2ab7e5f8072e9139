// photorque power: trace, then the solar array.
#include "tools/tasks/power.h"

#include "tools/commands/page.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/pages/pages.h"

namespace photorque::kinds::power {
namespace {

void run_power(const CommandLine& line) {
  const Console console = terminal(line);
  PowerRun run = power_of_experiment(line, console);
  if (line.page) run.result.files.push_back(power_page(run, page_head(line)));
  write_results(line, console, run.result);
}

}  // namespace

Verb kind() {
  Verb verb{"power", "Trace, then the solar array: current-voltage curve and maximum power point",
            run_power, true};
  verb.draws_page = true;
  return verb;
}

}  // namespace photorque::kinds::power
