#include "tools/sweeps/identity.h"

#include "core/files.h"
#include "core/provenance.h"
#include "scenes/experiment/document.h"
#include "scenes/experiment/named_files.h"
#include "scenes/experiment/toml.h"
#include "tools/coupling/table_cache.h"

namespace photorque {
namespace fs = std::filesystem;

RunIdentity::RunIdentity(RunOptions options, std::string command)
    : options_(std::move(options)),
      command_(std::move(command)),
      root_(parse_toml(options_.experiment_text(), options_.experiment.string())),
      folder_(options_.experiment.parent_path()) {
  const Provenance build = build_provenance();
  program_ = build.version + " " + build.git_hash;
}

SettingsNode RunIdentity::changed(const Changes& changes) const {
  RunOptions run = options_;
  run.overrides.insert(run.overrides.end(), changes.begin(), changes.end());
  SettingsNode root = root_;
  for (const std::string& assignment : run.all_overrides()) apply_override(root, assignment);
  std::get<SettingsNode::Table>(root.value).erase("sweep");
  return root;
}

// Content hash of a file. It is cached, so that a file that changes during a sweep keeps its first
// content.
std::string RunIdentity::content_of_file(const fs::path& path) {
  std::error_code failure;
  const auto time = fs::last_write_time(path, failure).time_since_epoch().count();
  const std::string key = path.string() + '\n' + std::to_string(fs::file_size(path, failure)) +
                          '\n' + std::to_string(time);
  const auto [at, is_new] = files_.try_emplace(key);
  if (!is_new) return at->second;
  const std::string bytes = read_file(path);
  std::string all = content_hash(bytes);
  for (const fs::path& file : files_named_in(path, bytes)) all += content_of_file(file);
  return files_[key] = content_hash(all);
}

std::string RunIdentity::of(const Changes& changes) {
  const auto file_behind = [this](const std::string& text) {
    const fs::path file = named_file(folder_, text);
    return file.empty() ? std::string() : "@" + content_of_file(file);
  };
  return content_hash(command_ + '\n' + program_ + '\n' +
                      canonical_text(changed(changes), {}, file_behind));
}

SettingsNode RunIdentity::value(const Changes& changes, const std::string& key) const {
  const SettingsNode root = changed(changes);
  const SettingsNode* found = find_setting(root, key);
  if (found == nullptr) {
    throw InputError({options_.experiment.string()}, key, "nothing",
                     "a value to start from, in the same unit");
  }
  return *found;
}

std::string RunIdentity::experiment(const Changes& changes, const std::vector<std::string>& head,
                                    const fs::path& folder) const {
  TomlDocument document(options_.experiment_text(), options_.experiment.string());
  document.root = changed(changes);
  for (const std::string& line : head) document.add_to_head(line);
  name_files_from(document.root, folder_, folder);
  return document.text();
}

}  // namespace photorque
