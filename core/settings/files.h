// Files that keys of an experiment name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/settings/settings.h"

namespace photorque {

// The path of the file `name`, relative to `folder`; without `name`, of the text of `key`.
// InputError with file, line and key if there is no such file. The message offers the file of the
// folder with the most similar name.
std::filesystem::path existing_file(const Settings& settings, std::string_view key,
                                    const std::filesystem::path& folder, const std::string& name);
std::filesystem::path existing_file(const Settings& settings, std::string_view key,
                                    const std::filesystem::path& folder);

}  // namespace photorque
