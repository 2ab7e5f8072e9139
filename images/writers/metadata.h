// What every file says about itself, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "core/product.h"
#include "core/provenance.h"

namespace photorque {

// {"program", "version", "git_hash", "seed", "inputs": {file: hash}}.
nlohmann::ordered_json provenance_json(const Provenance& provenance);

// {"name", "title", "unit", "x_label", …, "rows": "top row is the largest y", "provenance"}.
nlohmann::ordered_json map_json(const Map& map, const Provenance& provenance);

// One line of ASCII (other characters escaped), for formats whose text is ASCII or Latin-1.
std::string ascii_line(const nlohmann::ordered_json& json);

// A number, or null where it is not finite: JSON has no other way to say so.
nlohmann::ordered_json json_number(double value);

}  // namespace photorque
