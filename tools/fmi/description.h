// modelDescription.xml of a co-simulation unit.
#pragma once

#include <string>

#include "tools/fmi/unit.h"

namespace photorque {

// `name` of the model, `token` that a unit is instantiated with, `tool` that made it.
std::string model_description(const UnitDescription& unit, const std::string& name,
                              const std::string& token, const std::string& tool);

}  // namespace photorque
