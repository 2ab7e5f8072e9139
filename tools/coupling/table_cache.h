// Stored tables of light, identified by all inputs of their computation.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>

#include "core/numerics/table.h"
#include "core/settings/settings.h"

namespace photorque {

// Part of a key that identifies the program: table format, version and hash of the program file.
std::string table_cache_version();

// A value as text that is equal for equal values (3 equals 3.0). Keys in `without` are omitted at
// the top level. `behind` appends the content of files that texts of the tree name.
std::string canonical_text(const SettingsNode& node, const std::set<std::string>& without = {},
                           const std::function<std::string(const std::string& text)>& behind = {});

// Returns false if there is no such file or it is damaged.
bool read_cached_table(const std::filesystem::path& folder, const std::string& key,
                       RotationTable& table);
// Writes the file completely or not at all. Returns false if the folder is not writable.
bool write_cached_table(const std::filesystem::path& folder, const std::string& key,
                        const RotationTable& table);

}  // namespace photorque
