// Files that keys of an experiment name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/settings/settings.h"

namespace photorque {

// The path of the file `name`, relative to `folder`. Without `name`, the text of `key` is used.
// Throws InputError with file, line and key if there is no such file; the message suggests the file
// in the folder with the most similar name.
std::filesystem::path existing_file(const Settings& settings, std::string_view key,
                                    const std::filesystem::path& folder, const std::string& name);
std::filesystem::path existing_file(const Settings& settings, std::string_view key,
                                    const std::filesystem::path& folder);

}  // namespace photorque
