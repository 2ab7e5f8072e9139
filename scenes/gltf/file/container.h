// The outermost layer of a glTF file: plain JSON text, or the chunks of a binary file (.glb).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace photorque::gltf {

// Views into the bytes of the file.
struct Container {
  std::string_view json;
  std::optional<std::string_view> binary;  // the BIN chunk
  bool is_binary = false;
  std::vector<std::string> notices;
};

// Splits a file. It is binary when it begins with the magic "glTF" or `file` ends in ".glb".
// Throws InputError for everything that the specification's chapter 4 forbids: wrong magic or
// version, a length beyond the file, truncated, unaligned, missing, misplaced or repeated chunks.
// Bytes after the declared length and chunks of unknown type are passed over with a notice.
Container open_container(std::string_view bytes, const std::string& file);

}  // namespace photorque::gltf
