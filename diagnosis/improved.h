// improved.toml: the user's experiment with the missing physics added.
#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/diagnosis.h"

namespace photorque {

// `text` is the experiment as written and is kept to the last comment. Uncertain numbers of its
// disturbances that were fitted stand in it as fitted, beneath the line as it was written. Appended
// are: every found effect as a [[disturbance]] with its fitted values and standard errors; effects
// and torques without a law that were fitted beside them, so that the file is the model that was
// reported; uncertain numbers that have no place in the text, as comments; and, if the text has
// none, a [propagate] that propagates the first recording again. `folder` is where the result will
// stand: paths in it are relative to that.
std::string improved_experiment(const std::string& text, const Diagnosis& diagnosis,
                                const std::filesystem::path& folder);

}  // namespace photorque
