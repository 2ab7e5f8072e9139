// The tables of keys in the documents.
#pragma once

#include <string>
#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// A document with its tables of keys replaced, the text between the lines
//   <!-- keys WHAT begin -->
//   <!-- keys WHAT end -->
// WHAT is the path of a table, `array.day`, and for a table of kinds perhaps some of them, which
// are then all that is shown: `disturbance static_unbalance mass_shift`. Keys of a table or choice
// that were printed before are named only. InputError, naming `file`, for a path that no table has.
std::string with_key_tables(const std::string& document, const std::vector<Key>& tables,
                            const std::string& file);

}  // namespace photorque
