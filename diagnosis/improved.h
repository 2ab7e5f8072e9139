// improved.toml: the user's experiment with the missing physics added.
#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/diagnosis.h"
#include "scenes/experiment/document.h"

namespace photorque {

// `experiment` is the experiment as written. Uncertain numbers of its disturbances that were fitted
// stand in it as fitted, beneath a comment with the number as it was written. Appended are: every
// found effect as a [[disturbance]] with its fitted values and standard errors; effects and torques
// without a law that were fitted beside them, so that the file is the model that was reported;
// uncertain numbers that have no place in the text, as comments; and, if the text has none, a
// [propagate] that propagates the first recording again. `folder` is where the result will stand:
// the path of the recording is relative to it. NumericalError as of TomlDocument::text().
std::string improved_experiment(TomlDocument experiment, const Diagnosis& diagnosis,
                                const std::filesystem::path& folder);

}  // namespace photorque
