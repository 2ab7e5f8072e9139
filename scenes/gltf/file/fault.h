// Common functions of the glTF reader: error messages, limits of memory, and the check of a
// document against the schema.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/errors.h"

namespace photorque::gltf {

// Escapes one reference token of a JSON pointer (RFC 6901).
inline std::string pointer_token(const std::string& token) {
  std::string escaped;
  for (const char c : token) escaped += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return escaped;
}
inline std::string pointer_token(const char* token) {
  return pointer_token(std::string(token));
}
inline std::string pointer_token(size_t index) {
  return std::to_string(index);
}
inline std::string pointer_token(int index) {
  return std::to_string(index);
}

// JSON pointer from its parts, such as "/accessors/3/byteOffset".
template <typename... Parts>
std::string pointer(const Parts&... parts) {
  return (std::string() + ... + ("/" + pointer_token(parts)));
}

// Remaining memory for a model. Sizes stated in files are not trusted: they are charged here before
// memory is allocated.
class MemoryBudget {
 public:
  MemoryBudget(std::string file, uint64_t bytes)
      : file_(std::move(file)), left_(bytes), all_(bytes) {}

  // Throws InputError at `where` if `count` items of `item_bytes` exceed the remaining budget.
  void charge(uint64_t count, uint64_t item_bytes, const std::string& where) {
    if (count > left_ / item_bytes) {
      throw InputError({file_}, where,
                       std::to_string(count) + " items of " + std::to_string(item_bytes) + " bytes",
                       "a model that takes at most " + std::to_string(all_) + " bytes");
    }
    left_ -= count * item_bytes;
  }

 private:
  std::string file_;
  uint64_t left_;
  uint64_t all_;
};

// Checks the schema of a glTF document: required members, types, ranges, and that every index
// refers to an existing element. tinygltf replaces members of the wrong type by their defaults and
// does not check indices. Therefore the JSON is checked first, for everything on which geometry and
// optics depend. Throws InputError for the first violation; its key is a JSON pointer. Unknown
// members are ignored, as the specification requires.
void check_schema(const nlohmann::json& document, const std::string& file);

// The member of an object; null if there is none or the value is no object.
const nlohmann::json* member_of(const nlohmann::json& value, const char* key);
// An extension of an object; null if there is none.
const nlohmann::json* extension_of(const nlohmann::json& value, const char* name);

// Short description of a value for messages: "-3", "\"abc\"", "an array of 2".
std::string describe_json(const nlohmann::json& value);

}  // namespace photorque::gltf
