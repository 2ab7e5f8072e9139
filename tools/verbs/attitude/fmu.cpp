// photorque fmu: the platform for Simulink, OpenModelica and other importers of FMI 3.0.
#include "tools/fmi/pack.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::fmu {
namespace {

void add_options(Command& command, CommandOptions& options) {
  command.add_experiment(options);
}

void run(const CommandOptions& options, const Program&) {
  const Console console = terminal(options);
  write_results(options, console, pack_unit(options, console));
}

}  // namespace

Verb kind() {
  return {"fmu",
          "The platform as an FMI 3.0 unit for co-simulation in other programs",
          command_with(add_options, run),
          {"platform", "environment", "disturbance", "sensors", "propagate", "light", "array"},
          "[platform]"};
}

}  // namespace photorque::verbs::fmu
