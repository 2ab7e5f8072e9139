#include "scenes/experiment/named_files.h"

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/little_endian.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr size_t longest_path = 4096;

// Collects all texts of a JSON document.
void collect_texts(const nlohmann::json& node, std::vector<std::string>& texts) {
  if (node.is_string()) {
    texts.push_back(node.get<std::string>());
  } else if (node.is_structured()) {
    for (const auto& item : node) collect_texts(item, texts);
  }
}

// JSON text of a glTF or GLB file; empty for other files.
std::string json_of(const fs::path& path, const std::string& bytes) {
  constexpr size_t glb_head = 20;  // magic, version, length; length and type of the first chunk
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".gltf") return bytes;
  if (ending != ".glb" || bytes.size() < glb_head) return "";
  return bytes.substr(glb_head, little_endian_32(bytes, 12));
}

}  // namespace

fs::path named_file(const fs::path& folder, const std::string& text) {
  if (text.empty() || text.size() > longest_path || text.find('\0') != std::string::npos) return {};
  std::error_code failure;
  const fs::path path = folder / text;
  return fs::is_regular_file(path, failure) ? path : fs::path();
}

std::vector<fs::path> files_named_in(const fs::path& path, const std::string& bytes) {
  const std::string text_of_json = json_of(path, bytes);
  // No files for JSON that is nested too deeply; the reader of the model reports the error.
  if (extent_of_json(text_of_json).depth > deepest_json) return {};
  const auto json = nlohmann::json::parse(text_of_json, nullptr, false);
  std::vector<std::string> texts;
  if (!json.is_discarded()) collect_texts(json, texts);
  std::vector<fs::path> files;
  for (const std::string& text : texts) {
    fs::path file = named_file(path.parent_path(), text);
    if (file.empty()) file = named_file(path.parent_path(), percent_decoded(text).value_or(text));
    if (!file.empty() && file != path) files.push_back(std::move(file));
  }
  return files;
}

void name_files_from(SettingsNode& node, const fs::path& from, const fs::path& to) {
  static const std::set<std::string, std::less<>> names_of_parts = {
      "name", "node", "receiver", "kind", "source", "body", "topology"};
  if (auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    for (auto& [key, item] : *table) {
      const bool names_file = item.is_table() || item.is_array() || !names_of_parts.contains(key);
      if (names_file) name_files_from(item, from, to);
    }
  } else if (auto* items = std::get_if<SettingsNode::Array>(&node.value)) {
    for (SettingsNode& item : *items) name_files_from(item, from, to);
  } else if (auto* text = std::get_if<std::string>(&node.value)) {
    const fs::path file = named_file(from, *text);
    if (file.empty() || fs::path(*text).is_absolute()) return;
    *text = fs::absolute(file)
                .lexically_normal()
                .lexically_proximate(fs::absolute(to).lexically_normal())
                .generic_string();
  }
}

std::set<fs::path> all_named_files(const SettingsNode& root, const fs::path& folder) {
  std::set<fs::path> files;
  for_each_node(root, [&](const SettingsNode& node) {
    const auto* text = std::get_if<std::string>(&node.value);
    const fs::path file = text != nullptr ? named_file(folder, *text) : fs::path();
    if (file.empty() || !files.insert(fs::absolute(file).lexically_normal()).second) return;
    for (const fs::path& one : files_named_in(file, read_file(file))) {
      files.insert(fs::absolute(one).lexically_normal());
    }
  });
  return files;
}

}  // namespace photorque
