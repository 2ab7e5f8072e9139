// photorque fmu: the platform for Simulink, OpenModelica and other importers of FMI 3.0.
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/fmi/pack.h"

namespace photorque::kinds::fmu {
namespace {

void run_fmu(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, pack_unit(line, console));
}

}  // namespace

Verb kind() {
  return {"fmu", "The platform as an FMI 3.0 unit for co-simulation in other programs", run_fmu};
}

}  // namespace photorque::kinds::fmu
