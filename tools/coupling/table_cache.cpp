#include "tools/coupling/table_cache.h"

#include "core/files.h"
#include "core/provenance.h"
#include "core/text/format.h"

namespace photorque {
namespace {

constexpr const char* format = "photorque light table 2\n";
constexpr size_t hash_digits = 32;

std::filesystem::path file_of(const std::filesystem::path& folder, const std::string& key) {
  return folder / ("light_" + key + ".table");
}

}  // namespace

std::string table_cache_version() {
  // Contains a hash of the program file, because a version does not identify code under
  // development.
  return format + build_provenance().version + " " + content_hash(read_file(own_file())) + "\n";
}

std::string canonical_text(const SettingsNode& node, const std::set<std::string>& without,
                           const std::function<std::string(const std::string& text)>& behind) {
  struct Writer {
    const std::set<std::string>& without;
    const std::function<std::string(const std::string& text)>& behind;
    // The length is included, so that different sequences of values have different texts.
    static std::string counted(const std::string& text) {
      return std::to_string(text.size()) + ":" + text;
    }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(int64_t value) const { return (*this)(static_cast<double>(value)); }
    std::string operator()(double value) const { return printed("%.17g", value); }
    std::string operator()(const std::string& value) const {
      return counted(value) + (behind ? behind(value) : "");
    }
    std::string operator()(const SettingsNode::Array& items) const {
      std::string text = "[";
      for (const SettingsNode& item : items) text += canonical_text(item, {}, behind) + ",";
      return text + "]";
    }
    std::string operator()(const SettingsNode::Table& table) const {
      std::string text = "{";
      for (const auto& [key, value] : table) {
        if (without.contains(key)) continue;
        text += counted(key) + "=" + canonical_text(value, {}, behind) + ";";
      }
      return text + "}";
    }
  };
  return std::visit(Writer{without, behind}, node.value);
}

bool read_cached_table(const std::filesystem::path& folder, const std::string& key,
                       RotationTable& table) {
  const std::filesystem::path path = file_of(folder, key);
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) return false;
  try {
    const std::string all = read_file(path);
    const std::string head = format;
    if (!all.starts_with(head) || all.size() < head.size() + hash_digits) return false;
    const std::string bytes = all.substr(head.size() + hash_digits);
    return all.compare(head.size(), hash_digits, content_hash(bytes)) == 0 && table.read(bytes);
  } catch (const InputError&) {
    return false;
  }
}

bool write_cached_table(const std::filesystem::path& folder, const std::string& key,
                        const RotationTable& table) {
  const std::string bytes = table.bytes();
  try {
    write_file_whole(file_of(folder, key), format + content_hash(bytes) + bytes);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace photorque
