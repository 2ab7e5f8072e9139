// Access of a model to other files in its folder.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace photorque {

// Returns the bytes of a relative path (percent-decoded), or nothing. Throws InputError if the
// path, or a link on it, leaves the model's folder and this is not allowed.
using GltfOpen = std::function<std::optional<std::string>(const std::string& relative_path)>;

}  // namespace photorque
