// Tables of light on disk, by the content of everything that they were made from.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>

#include "core/numerics/table.h"
#include "core/settings/settings.h"

namespace photorque {

// The part of a key that belongs to the program: its format of tables, version and own bytes.
std::string table_cache_version();

// A value as text, equal for equal values (3 is 3.0); without the named keys of the top level.
// `behind` adds what a text of the tree names.
std::string canonical_text(const SettingsNode& node, const std::set<std::string>& without = {},
                           const std::function<std::string(const std::string& text)>& behind = {});

// False where there is none or the file is damaged.
bool read_cached_table(const std::filesystem::path& folder, const std::string& key,
                       RotationTable& table);
// Whole or not at all. False where the folder cannot be written.
bool write_cached_table(const std::filesystem::path& folder, const std::string& key,
                        const RotationTable& table);

}  // namespace photorque
