// photorque fmu: the platform for Simulink, OpenModelica and other importers of FMI 3.0 or 2.0.
#include "tools/fmi/pack.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::fmu {
namespace {

struct FmuOptions : CommandOptions {
  int fmi = 3;
};

void add_options(Command& command, FmuOptions& options) {
  command.add_experiment(options);
  command.add("--fmi", options.fmi, "Version of the Functional Mock-up Interface: 3 or 2").range =
      Option::Between<int>(2, 3);
}

void run(const FmuOptions& options, const Program&) {
  const Console console = terminal(options);
  const FmiVersion version = options.fmi == 2 ? FmiVersion::two : FmiVersion::three;
  write_results(options, console, pack_unit(options, console, version));
}

}  // namespace

Verb kind() {
  return {
      "fmu",
      "The platform as an FMI unit (3.0 or 2.0) for co-simulation in other programs",
      command_with(add_options, run),
      {"platform", "environment", "disturbance", "sensors", "propagate", "serve", "light", "array"},
      "[platform]"};
}

}  // namespace photorque::verbs::fmu
