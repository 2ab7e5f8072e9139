// How a model reaches the files beside it.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace photorque {

// The bytes behind a relative path (percent decoded, inside the model's folder), or nothing.
using GltfOpen = std::function<std::optional<std::string>(const std::string& relative_path)>;

}  // namespace photorque
