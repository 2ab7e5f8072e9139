// All keys of an experiment, and what is made from them: a JSON Schema (draft 7), which editors of
// TOML complete and check with, the tables of the documents, and texts about a key.
#pragma once

#include <string>
#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// The tables of an experiment, in the order in which documents show them.
std::vector<Key> experiment_keys();

// The schema of a file with these tables. The descriptions contain units, ranges and defaults. Any
// unit of a quantity is accepted, with the bounds in that unit. Keys of a choice (`kind`,
// `profile`) are accepted only with it, and unknown keys are rejected. `check` tests conditions on
// several keys or on files.
//
// Conditions are in `if` and `then`, and all properties are on the same level, because taplo does
// not evaluate conditions when it completes and shows keys.
std::string json_schema(const std::vector<Key>& tables);

// A document with its tables of keys replaced, the text between the lines
//   <!-- keys WHAT begin -->
//   <!-- keys WHAT end -->
// WHAT is the path of a table, `array.day`, and for a table of kinds perhaps some of them, which
// are then all that is shown: `disturbance static_unbalance mass_shift`. Keys of a table or choice
// that were printed before are named only. InputError, naming `file`, for a path that no table has.
std::string with_key_tables(const std::string& document, const std::vector<Key>& tables,
                            const std::string& file);

// A number in twelve digits, as people write it.
std::string short_number(double x);

// Type, meaning, words of a choice, unit, range and default, one after the other.
std::string description_of(const Key& key);
// "> 0", "[0, 90]", "1 … 1024", `"grid"`, `"ring"`; empty where every value will do.
std::string range_in_words(const Key& key);
// The default as TOML, or in words; "required".
std::string default_in_words(const Key& key);
// The words of a choice with their meanings: "`\"table\"`: traced once; …"; empty if the meanings
// only repeat the words.
std::string choices_in_words(const Key& key);

}  // namespace photorque
