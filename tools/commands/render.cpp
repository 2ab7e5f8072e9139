// photorque render: a picture of the scene with the irradiance painted on its receivers.
#include "tools/tasks/render.h"

#include "tools/commands/terminal.h"

namespace photorque::kinds::render {
namespace {

void run_render(const CommandLine& line) {
  const Console console = terminal(line);
  const RenderRun rendered = render_experiment(line, console);
  console.heading("Written to " + write_render(rendered, line.out_folder()).string());
}

}  // namespace

Verb kind() {
  return {"render", "A picture of the scene with the irradiance painted on its receivers",
          run_render, true};
}

}  // namespace photorque::kinds::render
