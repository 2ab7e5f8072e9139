// Common functions of the glTF reader: error messages, limits of memory, and the check of a
// document against the schema.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/errors.h"

namespace photorque::gltf {

// One reference token of a JSON pointer (RFC 6901).
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

// "/accessors/3/byteOffset" from its parts.
template <typename... Parts>
std::string pointer(const Parts&... parts) {
  return (std::string() + ... + ("/" + pointer_token(parts)));
}

// Memory that a model may still take. Sizes in files are claims: they are charged here before
// anything of that size is allocated.
class MemoryBudget {
 public:
  MemoryBudget(std::string file, uint64_t bytes)
      : file_(std::move(file)), left_(bytes), all_(bytes) {}

  // Throws InputError at `where` when `count` items of `item_bytes` are more than the budget that
  // remains.
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

// The shape of a glTF document: which members exist, of what type, in which range, and that every
// index points at something. tinygltf replaces members of the wrong type by their defaults and
// keeps indices as they are, so this is checked before, on the JSON itself, for everything that
// geometry and optics depend on. Throws InputError for the first violation, its key a JSON pointer.
// Unknown members are ignored, as the specification requires.
void check_schema(const nlohmann::json& document, const std::string& file);

// A short description of a value for messages: "-3", "\"abc\"", "an array of 2".
std::string describe_json(const nlohmann::json& value);

}  // namespace photorque::gltf
