// The shape of a glTF document: which members exist, of what type, in which range, and that every
// index points at something.
//
// tinygltf replaces members of the wrong type by their defaults and keeps indices as they are, so
// this is checked before, on the JSON itself, for everything that geometry and optics depend on.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace photorque::gltf {

// Throws InputError for the first violation, its key a JSON pointer. Members that are not known are
// passed over, as the specification asks.
void check_schema(const nlohmann::json& document, const std::string& file);

// A short description of a value for messages: "-3", "\"abc\"", "an array of 2".
std::string describe_json(const nlohmann::json& value);

}  // namespace photorque::gltf
