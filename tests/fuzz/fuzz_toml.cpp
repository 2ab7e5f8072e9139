// The TOML reader on arbitrary text, and overrides on the tree that it gives: InputError or a tree,
// nothing else.
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/errors.h"
#include "scenes/experiment/toml_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const size_t line = text.find('\n');
  try {
    photorque::SettingsNode root = photorque::parse_toml(
        line == std::string::npos ? text : text.substr(line + 1), "fuzz.toml");
    photorque::apply_override(root, text.substr(0, line));
    photorque::Settings(std::make_shared<const photorque::SettingsNode>(root)).finish();
  } catch (const photorque::InputError&) {
  }
  return 0;
}
