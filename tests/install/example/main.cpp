// Absorbed light of an experiment, and the motion of a platform that is defined here.
#include <cstdio>

#include "attitude/disturbances/kind.h"
#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "tools/verbs/trace.h"

int main(int, char** arguments) {
  using namespace photorque;
  RunOptions options;
  options.experiment = arguments[1];
  options.overrides = {"trace.rays=65536"};
  const TraceRun traced = run_trace(options, Console());
  std::printf("absorbed %.17g W\n", traced.light.power_balance.absorbed_W.value);

  PropagationRun run;
  run.model.platform.mass_kg = 7.0;
  run.model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.19).asDiagonal();
  run.model.disturbances.push_back(
      make_disturbance_of("static_unbalance", {{"offset_m", {1e-6, 0.0, -1e-5}}},
                          {run.model.platform, run.model.environment}));
  run.duration_s = 10.0;
  std::printf("tilt %.17g rad\n", tilt_rad(propagate(run).states.back()));

  options.experiment = "absent.toml";
  try {
    run_trace(options, Console());
  } catch (const InputError& error) {
    std::printf("error %s\n", error.what());
  }
}
