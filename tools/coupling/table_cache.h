// Tables of light on disk, by the content of everything that they were made from.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "core/numerics/table.h"
#include "core/settings/settings.h"

namespace photorque {

// The part of a key that belongs to the program: its format of tables, version and own bytes.
std::string table_cache_version();

// A value as text, equal for equal values; without the named keys of the top level.
std::string written_out(const SettingsNode& node, const std::set<std::string>& without = {});

// False where there is none or the file is damaged.
bool read_cached_table(const std::filesystem::path& folder, const std::string& key,
                       RotationTable& table);
// Whole or not at all. False where the folder cannot be written.
bool write_cached_table(const std::filesystem::path& folder, const std::string& key,
                        const RotationTable& table);

}  // namespace photorque
