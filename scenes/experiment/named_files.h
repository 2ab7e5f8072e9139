// The files that an experiment names, and those that these name in turn.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// The file that a text names from a folder; empty where it names none.
std::filesystem::path named_file(const std::filesystem::path& folder, const std::string& text);

// The files that a model's file (glTF, GLB) names: its buffers and pictures. `bytes` are the
// file's.
std::vector<std::filesystem::path> files_named_in(const std::filesystem::path& path,
                                                  const std::string& bytes);

// Absolute normal paths of all files to which texts of the tree refer, relative to `folder`, and of
// the files to which these refer.
std::set<std::filesystem::path> all_named_files(const SettingsNode& root,
                                                const std::filesystem::path& folder);

// Names the files that texts of the tree name from the folder `from` as seen from the folder `to`.
// Absolute paths stay, as do texts under keys that name other things (name, node, kind, …).
void name_files_from(SettingsNode& node, const std::filesystem::path& from,
                     const std::filesystem::path& to);

}  // namespace photorque
