// Fuzz target: any text as TOML, and its first line as an override of the tree that it gives.
// line_mutator.cpp changes lines, keys and values, not only bytes.
#include "scenes/experiment/toml.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const std::string text = fuzz::text_of(data, size);
  const size_t line = text.find('\n');
  fuzz::may_refuse([&] {
    SettingsNode root =
        parse_toml(line == std::string::npos ? text : text.substr(line + 1), "fuzz.toml");
    apply_override(root, text.substr(0, line));
    find_setting(root, text.substr(0, text.find('=')));
    Settings(root).finish();
  });
  return 0;
}
