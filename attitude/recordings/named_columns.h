// Columns that [recording] names, and whole texts, for recordings of all kinds.
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

// A cell of a header as UTF-8. If it is not valid UTF-8, its bytes are read as Latin-1, as in
// "Winkel [\xb0]".
std::string header_cell_text(std::string_view cell);

// InputError for a column that [recording] names but no recording has, for example due to a
// spelling error. `absent_columns`: a set of absent names for each recording.
void refuse_absent_columns(const Settings& recording,
                           const std::vector<std::set<std::string>>& absent_columns);

}  // namespace photorque
