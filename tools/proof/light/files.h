// An injected case of light and power as files.
#pragma once

#include <filesystem>

#include "tools/proof/light/case.h"

namespace photorque {

// experiment.toml, scene.gltf, the recordings as .csv.gz, oracle.toml (the experiment with what
// acts) where `[[effect]]` can say it and, last, truth.json: a folder that has one is complete.
void write_light_case(const LightCase& c, const std::filesystem::path& folder);

}  // namespace photorque
