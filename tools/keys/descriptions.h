// Texts about a key: its description, default and range in words.
#pragma once

#include <string>

#include "core/settings/keys.h"

namespace photorque {

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
