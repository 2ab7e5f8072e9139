// Files that an experiment names, and files that these name in turn.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// The file that a text names relative to a folder; empty if it names none.
std::filesystem::path named_file(const std::filesystem::path& folder, const std::string& text);

// Files that a model (glTF, GLB) names: its buffers and pictures. `bytes` is the content of the
// model's file.
std::vector<std::filesystem::path> files_named_in(const std::filesystem::path& path,
                                                  const std::string& bytes);

// Absolute normalised paths of all files that texts of the tree name, relative to `folder`, and of
// the files that these name.
std::set<std::filesystem::path> all_named_files(const SettingsNode& root,
                                                const std::filesystem::path& folder);

// Rewrites relative file names in texts of the tree from the folder `from` to the folder `to`.
// Absolute paths and texts under other keys (name, node, kind, …) are unchanged.
void name_files_from(SettingsNode& node, const std::filesystem::path& from,
                     const std::filesystem::path& to);

}  // namespace photorque
