// All keys of an experiment, and outputs made from them: a JSON Schema (draft 7) for completion and
// checks in TOML editors, the tables of the documents, and texts about a key.
#pragma once

#include <string>
#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// Tables of an experiment in the order of the documents.
std::vector<Key> experiment_keys();

// The schema of a file with these tables. The descriptions contain units, ranges and defaults. Any
// unit of a quantity is accepted, with the bounds in that unit. Keys of a choice (`kind`,
// `profile`) are accepted only with it, and unknown keys are rejected. `check` tests conditions on
// several keys or on files.
//
// Conditions are in `if` and `then`, and all properties are on the same level, because taplo does
// not evaluate conditions when it completes and shows keys.
std::string json_schema(const std::vector<Key>& tables);

// Replaces the tables of keys in a document, which are between the lines
//   <!-- keys WHAT begin -->
//   <!-- keys WHAT end -->
// WHAT is the path of a table, such as `array.day`. For a table of kinds it may also list some
// kinds, and only these are shown: `disturbance static_unbalance mass_shift`. Keys of a table or
// choice that were printed before are only named. Throws InputError with the name `file` for an
// unknown path.
std::string with_key_tables(const std::string& document, const std::vector<Key>& tables,
                            const std::string& file);

// A number with twelve digits, without trailing zeros.
std::string short_number(double x);

// Type, meaning, values of a choice, unit, range and default as one text.
std::string description_of(const Key& key);
// Range as text: "> 0", "[0, 90]", "1 … 1024", `"grid"`, `"ring"`; empty if every value is allowed.
std::string range_in_words(const Key& key);
// Default as TOML or as text; "required" if there is none.
std::string default_in_words(const Key& key);
// Values of a choice with their meanings: "`\"table\"`: traced once; …"; empty if the meanings only
// repeat the values.
std::string choices_in_words(const Key& key);

}  // namespace photorque
