// photorque fit-cell: the parameters of a solar cell, module or shaded string from measurements.
#include "tools/tasks/fit_cell.h"

#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque::kinds::fit_cell {
namespace {

void run_fit_cell(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, fit_cell_of_experiment(line, console));
}

}  // namespace

Verb kind() {
  return {"fit-cell",
          "Solar cell parameters, with errors, from current-voltage sweeps or a datasheet",
          run_fit_cell};
}

}  // namespace photorque::kinds::fit_cell
