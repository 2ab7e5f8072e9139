// photorque count: how many triangles a scene has.
#include "tools/runs/optical_run.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::count {
namespace {

struct Options : CommandOptions {
  bool parts = false;
};

void add_options(Command& command, Options& options) {
  command.add_experiment(options, Command::Folder::none);
  command.add("--parts", options.parts, "Print how many every part has");
}

void run(const Options& options, const Program&) {
  const Console console = terminal(options);
  const OpticalRun lit(options, Console());
  const Scene& scene = lit.experiment().scene;
  size_t all = 0;
  for (const Instance& instance : scene.instances) {
    const size_t triangles = scene.meshes[instance.mesh].triangles.size();
    if (options.parts) console.line(instance.path + " " + std::to_string(triangles));
    all += triangles;
  }
  console.line(std::to_string(all) + " triangles");
}

}  // namespace

Verb kind() {
  return {"count",
          "How many triangles the scene has",
          command_with(add_options, run),
          {"scene", "source", "receiver"},
          "[scene] and [[source]]"};
}

}  // namespace photorque::verbs::count
