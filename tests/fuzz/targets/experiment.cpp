// Fuzz target: any text as an experiment with light: a scene, lamps, receivers and the attitude, or
// an InputError. The files that it may name stand in tests/fuzz/project. line_mutator.cpp changes
// lines, keys and values, not only bytes.
#include "scenes/experiment/experiment.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  static const std::filesystem::path folder(PHOTORQUE_FUZZ_PROJECT);
  fuzz::may_refuse([&] {
    const Experiment experiment =
        resolve_experiment(read_experiment_text(folder / "fuzz.toml", fuzz::text_of(data, size)));
    const RigidTransform& stands = experiment.lab_from_body;
    if (experiment.beams.empty() || !stands.rotation.coeffs().allFinite()) std::abort();
  });
  return 0;
}
