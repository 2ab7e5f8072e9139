// The columns that [recording] columns names, and whole texts, for recordings of any kind.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// All lines of a file, which may be compressed, each with "\n". `header` and InputError as for
// TextLines.
std::string whole_text(const std::filesystem::path& path,
                       const std::vector<std::string>& header = {});

// A cell of a header as UTF-8: bytes that are none are of Latin-1, as of "Winkel [\xb0]".
std::string header_cell_text(std::string_view cell);

// InputError for a column that [recording] names and that all of these sets contain: the names that
// a recording lacks, a set for each. Misspelt, it would be read over.
void refuse_absent_columns(const Settings& recording,
                           const std::vector<std::set<std::string>>& absent_columns);

}  // namespace photorque
