#include "tools/sweeps/store/identity.h"

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/provenance.h"
#include "scenes/experiment/toml_reader.h"
#include "scenes/experiment/toml_writer.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr size_t longest_path = 4096;

// The file that a text names from a folder; empty where it names none.
fs::path named_file(const fs::path& folder, const std::string& text) {
  if (text.empty() || text.size() > longest_path || text.find('\0') != std::string::npos) return {};
  std::error_code failure;
  const fs::path path = folder / text;
  return fs::is_regular_file(path, failure) ? path : fs::path();
}

// "a%20b" is "a b" in a URI.
std::string percent_decoded(const std::string& text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::sscanf(text.substr(i + 1, 2).c_str(), "%2x", &byte) == 1) {
      decoded += static_cast<char>(byte);
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

// All texts of a JSON document.
void collect_texts(const nlohmann::json& node, std::vector<std::string>& texts) {
  if (node.is_string()) {
    texts.push_back(node.get<std::string>());
  } else if (node.is_structured()) {
    for (const auto& item : node) collect_texts(item, texts);
  }
}

// The JSON of a glTF or GLB file; empty for any other.
std::string json_of(const fs::path& path, const std::string& bytes) {
  constexpr size_t glb_head = 20;  // magic, version, length; length and type of the first chunk
  if (path.extension() == ".gltf") return bytes;
  if (path.extension() != ".glb" || bytes.size() < glb_head) return "";
  size_t length = 0;
  for (size_t i = 0; i < 4; ++i) {
    length |= static_cast<size_t>(static_cast<unsigned char>(bytes[12 + i])) << (8 * i);
  }
  return bytes.substr(glb_head, length);
}

// What a model's file names in turn.
std::vector<fs::path> files_named_in(const fs::path& path, const std::string& bytes) {
  const auto json = nlohmann::json::parse(json_of(path, bytes), nullptr, false);
  std::vector<std::string> texts;
  if (!json.is_discarded()) collect_texts(json, texts);
  std::vector<fs::path> files;
  for (const std::string& text : texts) {
    fs::path file = named_file(path.parent_path(), text);
    if (file.empty()) file = named_file(path.parent_path(), percent_decoded(text));
    if (!file.empty() && file != path) files.push_back(std::move(file));
  }
  return files;
}

void name_files_from(SettingsNode& node, const fs::path& from, const fs::path& to) {
  if (auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    for (auto& [key, item] : *table) name_files_from(item, from, to);
  } else if (auto* items = std::get_if<SettingsNode::Array>(&node.value)) {
    for (SettingsNode& item : *items) name_files_from(item, from, to);
  } else if (auto* text = std::get_if<std::string>(&node.value)) {
    const fs::path file = named_file(from, *text);
    if (file.empty() || fs::path(*text).is_absolute()) return;
    *text = fs::absolute(file).lexically_normal().lexically_proximate(to).generic_string();
  }
}

}  // namespace

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

// A file that changes while a sweep runs counts as it was when it was first asked for.
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

std::string RunIdentity::content(const SettingsNode& node) {
  if (const auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    std::string all = "{";
    for (const auto& [key, value] : *table) {
      all += std::to_string(key.size()) + ':' + key + '=' + content(value) + ';';
    }
    return all + '}';
  }
  if (const auto* items = std::get_if<SettingsNode::Array>(&node.value)) {
    std::string all = "[";
    for (const SettingsNode& item : *items) all += content(item) + ',';
    return all + ']';
  }
  if (const auto* text = std::get_if<std::string>(&node.value)) {
    const fs::path file = named_file(folder_, *text);
    return std::to_string(text->size()) + ':' + *text +
           (file.empty() ? "" : "@" + content_of_file(file));
  }
  // 3 is 3.0.
  if (const auto* whole = std::get_if<int64_t>(&node.value)) {
    return toml_value({static_cast<double>(*whole), {}});
  }
  return toml_value(node);
}

std::string RunIdentity::of(const Changes& changes) {
  return content_hash(command_ + '\n' + program_ + '\n' + content(changed(changes)));
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

std::string RunIdentity::experiment(const Changes& changes, const std::string& head,
                                    const fs::path& folder) const {
  SettingsNode root = changed(changes);
  name_files_from(root, folder_, fs::absolute(folder).lexically_normal());
  return head + toml_document(std::get<SettingsNode::Table>(root.value));
}

}  // namespace photorque
