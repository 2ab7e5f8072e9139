// Access of a model to the files beside it.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace photorque {

// The bytes behind a relative path (percent decoded), or nothing. InputError where the path, or a
// link on it, leads out of the model's folder and may not.
using GltfOpen = std::function<std::optional<std::string>(const std::string& relative_path)>;

}  // namespace photorque
