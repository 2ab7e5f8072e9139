// photorque serve: the platform in real time beside hardware and programs.
#include "tools/tasks/serve.h"

#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque::kinds::serve {
namespace {

void run_serve(const CommandLine& line) {
  const Console console = terminal(line);
  write_results(line, console, serve_experiment(line, console));
}

}  // namespace

Verb kind() {
  return {"serve",
          "The platform in real time: measurements out, commands in, over UDP",
          run_serve};
}

}  // namespace photorque::kinds::serve
