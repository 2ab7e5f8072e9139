// improved.toml: the user's experiment with the missing physics added.
#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/diagnosis.h"
#include "scenes/experiment/document.h"

namespace photorque {

// `experiment` is the experiment as written. Fitted uncertain values of its disturbances replace
// the written ones, which remain as comments above. Appended are: every found effect as a
// [[disturbance]] with fitted values and standard errors; further fitted effects and empirical
// torques, so that the file is the reported model; uncertain values without a place in the text, as
// comments; and, if absent, a [propagate] for the first recording. `folder` is the location of the
// result; the path of the recording is relative to it. Throws NumericalError like
// TomlDocument::text().
std::string improved_experiment(TomlDocument experiment, const Diagnosis& diagnosis,
                                const std::filesystem::path& folder);

}  // namespace photorque
