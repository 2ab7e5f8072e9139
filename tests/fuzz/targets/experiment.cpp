// Fuzz target: any text as an experiment with light: a scene, lamps, receivers, joints and the
// attitude, or an InputError. The files that it may name stand in tests/fuzz/project.
// line_mutator.cpp changes lines, keys and values, not only bytes.
#include "scenes/experiment/experiment.h"

#include "core/constants.h"
#include "tests/fuzz/target.h"

namespace {

using namespace photorque;

void use(const Beam& beam) {
  for (const double angle_rad : {0.0, 0.1, 1.0, 0.5 * pi, 3.0}) {
    if (!(beam.emitter->relative_intensity(angle_rad) >= 0.0)) std::abort();
  }
  if (!(beam.emitter->power_W() > 0.0)) std::abort();
}

void use(const Joint& joint) {
  for (const double time_s : {-1e9, 0.0, 1.0, 5.0, 1e9}) {
    if (!std::isfinite(joint.angle_at(time_s))) std::abort();
  }
  if (joint.towards_sun && !std::isfinite(joint.angle_towards({1.0, 2.0, 3.0}))) std::abort();
  const JointPositions positions(joint);
  for (const double angle_rad : positions.angles_rad()) {
    if (!std::isfinite(angle_rad)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::filesystem::path folder(PHOTORQUE_FUZZ_PROJECT);
  fuzz::may_refuse([&] {
    const Experiment experiment =
        resolve_experiment(read_experiment_text(folder / "fuzz.toml", fuzz::text_of(data, size)));
    const RigidTransform& stands = experiment.lab_from_body;
    if (experiment.beams.empty() || !stands.rotation.coeffs().allFinite()) std::abort();
    for (const Beam& beam : experiment.beams) use(beam);
    for (const Joint& joint : experiment.file.joints) use(joint);
  });
  return 0;
}
