// improved.toml: the user's experiment with the missing physics added.
#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/diagnosis.h"

namespace photorque {

// `text` is the experiment as written and is kept to the last comment. Appended are: every found
// effect as a [[disturbance]] with its fitted values and standard errors, by which it can be
// diagnosed and propagated again; what the fit says about uncertain priors, as comments; and, if
// the text has none, a [propagate] that propagates the first recording again. An empirical torque
// that no kind of the catalogue can hold is described in a comment. `folder` is where the result
// will stand: paths in it are relative to that.
std::string improved_experiment(const std::string& text, const Diagnosis& diagnosis,
                                const std::filesystem::path& folder);

}  // namespace photorque
