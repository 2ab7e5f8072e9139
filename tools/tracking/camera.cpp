#include "tools/tracking/camera.h"

#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "tools/runs/camera_sight.h"

namespace photorque {
namespace {

// Poses found from images in a second: the centres are read from pixels, the pixels at hand.
double pace_1_s(const CameraStudy& study) {
  constexpr int images = 200;
  const WallTime wall;
  for (int i = 0; i < images; ++i) {
    take_image(study.camera, {}, {}, study.seed, static_cast<uint64_t>(i));
  }
  return images / wall.elapsed_s();
}

}  // namespace

CameraRun camera_of_experiment(const RunOptions& options, const Console& console) {
  const WallTime wall;
  const AttitudeExperiment experiment(options);
  NominalModel nominal = read_attitude_model(experiment.settings());
  if (!nominal.sensors.camera || !nominal.sensors.camera->geometry) {
    throw InputError({options.experiment.string()}, "sensors.camera.markers_m", "nothing",
                     "the places of the markers, and the camera's lens and sensor");
  }
  const auto inputs = look_through_scene(experiment.file(), nominal.sensors);
  CameraRun run;
  run.study = read_camera_study(experiment.settings(), *nominal.sensors.camera->geometry,
                                nominal.model.platform.tilt_limit_rad);
  if (options.seed) run.study.seed = *options.seed;
  run.study.threads = options.threads;
  run.result.product = camera_product(run.study, console.progress("exposing"));
  console.done();
  run.result.provenance = experiment.provenance(run.study.seed);
  run.result.provenance.inputs.insert(run.result.provenance.inputs.end(), inputs.begin(),
                                      inputs.end());
  run.images_per_s = pace_1_s(run.study);
  run.result.cost = {wall.elapsed_s(), {}};
  return run;
}

}  // namespace photorque
