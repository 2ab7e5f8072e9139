// photorque serve: the platform in real time beside hardware and programs.
#include "tools/realtime/run/serve.h"

#include "tools/verbs/verb.h"

namespace photorque::kinds::serve {
namespace {

void add_options(Command& command, CommandOptions& options) {
  command.add_experiment(options);
}

void run(const CommandOptions& options, const Program&) {
  const Console console = terminal(options);
  write_results(options, console, serve_experiment(options, console));
}

}  // namespace

Verb kind() {
  return {"serve",
          "The platform in real time: measurements out, commands in, over UDP or shared memory",
          command_with(add_options, run),
          {"platform", "environment", "disturbance", "sensors", "propagate", "serve", "light"},
          "[platform]"};
}

}  // namespace photorque::kinds::serve
