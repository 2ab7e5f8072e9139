// TOML text into the tree that core/settings reads. The only place for toml++; document.h writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// The tree of a TOML document. `name` is how messages call it; every value remembers its line.
// Dates and times become their ISO 8601 text. Throws InputError with the line of a syntax error.
SettingsNode parse_toml(const std::string& text, const std::string& name);

// Reads a file.
SettingsNode read_toml(const std::filesystem::path& path);

// A comment of a TOML text.
struct TomlComment {
  int line = 0;         // from one
  std::string text;     // from # on
  bool beside = false;  // stands behind a value on its line, or within a value of several lines
};
// The comments of a text that parse_toml() takes, in order.
std::vector<TomlComment> toml_comments(const std::string& text);

// Sets one value as the command line's `--set KEY=VALUE` does: "source[0].power_W=10".
//
// KEY is a path of names and indices from the root; tables on the way that do not exist are made,
// array items are not. VALUE is TOML; a bare word (a name, a path) is a text. A key of the same
// quantity in another unit is replaced: power_mW=5 takes the place of power_W. Messages about the
// value say "--set" instead of a file. Throws InputError when the assignment makes no sense.
void apply_override(SettingsNode& root, const std::string& assignment);

// The value under such a KEY; null where there is none, or KEY is no path.
const SettingsNode* find_setting(const SettingsNode& root, const std::string& key);

}  // namespace photorque
