// photorque supply: ways to bring power aboard, side by side.
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/supply/task.h"

namespace photorque::kinds::supply {
namespace {

void run_supply(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, supply_of_experiment(line, console).result);
}

}  // namespace

Verb kind() {
  return {"supply",
          "Battery, cable, microwaves, coils or light: what each delivers, weighs and disturbs",
          run_supply};
}

}  // namespace photorque::kinds::supply
