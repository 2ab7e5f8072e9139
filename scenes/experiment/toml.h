// Reads TOML text into the tree of core/settings. The only place for toml++; document.h writes
// TOML.
#pragma once

#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// The tree of a TOML document. Messages call it `name`; every value stores its line. Dates and
// times become their ISO 8601 text. Throws InputError with the line of a syntax error.
SettingsNode parse_toml(const std::string& text, const std::string& name);

// A comment of a TOML text.
struct TomlComment {
  int line = 0;         // from one
  std::string text;     // including the #
  bool beside = false;  // after a value on its line, or within a value of several lines
};
// Comments of a text that parse_toml() accepts, in order.
std::vector<TomlComment> toml_comments(const std::string& text);

// Sets one value as the command line's `--set KEY=VALUE` does: "source[0].power_W=10".
//
// KEY is a path of names and indices from the root. Missing tables on the path are created, missing
// array items are not. VALUE is TOML; a bare word (a name, a path) is a text. A key of the same
// quantity in another unit is replaced: power_mW=5 replaces power_W. Messages about the value
// contain "--set" instead of a file. Throws InputError for an invalid assignment.
void apply_override(SettingsNode& root, const std::string& assignment);

// The value at such a KEY; null if there is none or if KEY is not a path.
const SettingsNode* find_setting(const SettingsNode& root, const std::string& key);

}  // namespace photorque
