// Comparison of the declared keys with their readers: for keys_test.cpp.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/files.h"
#include "core/settings/keys.h"
#include "scenes/experiment/document.h"
#include "scenes/experiment/toml.h"
#include "tools/verbs/check.h"

namespace photorque {

inline const std::filesystem::path examples =
    std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "tests/data/keys";

inline std::vector<std::filesystem::path> example_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(examples)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

inline SettingsNode parsed(const std::filesystem::path& file) {
  return parse_toml(read_file(file), file.string());
}

inline CheckReport checked(const std::filesystem::path& file, const SettingsNode& root,
                           KeyCheck keys) {
  RunOptions options;
  options.experiment = file;
  options.text = toml_document(std::get<SettingsNode::Table>(root.value));
  return run_check(options, keys);
}

inline std::string all_of(const CheckReport& report) {
  std::string lines;
  for (const InputError& mistake : report.mistakes) lines += std::string(mistake.what()) + "\n";
  return lines;
}

inline bool is_same_quantity(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const KeyUnit x = unit_of_key(a), y = unit_of_key(b);
  return !x.unit.empty() && x.stem == y.stem && x.dimension == y.dimension;
}

inline SettingsNode of_wrong_type(const Key& key) {
  if (key.type == Key::Type::flag) return {int64_t{7}};
  if (key.type == Key::Type::other && (key.forms & Key::a_flag) != 0) return {1.5};
  return {true};
}

// Sets one key after the other to a value of the wrong type, and compares what the readers say.
class Readers {
 public:
  explicit Readers(const std::vector<Key>& tables) : tables_(tables) {}

  void try_all(const std::filesystem::path& file) {
    SettingsNode root = parsed(file);
    auto& tables = std::get<SettingsNode::Table>(root.value);
    // One lamp at a time: every key reads the whole file again.
    const auto lamps = tables.find("source");
    const SettingsNode all = lamps != tables.end() ? lamps->second : SettingsNode{};
    const auto* each = std::get_if<SettingsNode::Array>(&all.value);
    for (size_t i = 0; i < (each != nullptr ? each->size() : 1); ++i) {
      if (each != nullptr) lamps->second.value = SettingsNode::Array{(*each)[i]};
      try_table(file, root, tables, tables_, "", "");
    }
  }

  // Declared keys that no reader knows as they are declared.
  std::set<std::string> amiss() const {
    std::set<std::string> left;
    for (const auto& [key, message] : tried_) {
      if (!agreed_.contains(key)) left.insert(key + ": " + message);
    }
    return left;
  }
  const std::set<std::string>& agreed() const { return agreed_; }

 private:
  // `path` names the table with the choices made in it, `name` as messages do.
  void try_table(const std::filesystem::path& file, SettingsNode& root, SettingsNode::Table& table,
                 const std::vector<Key>& keys, const std::string& path, const std::string& name) {
    for (const auto& [key, chosen] : with_choices(table, keys, path)) {
      const std::string id = chosen + "." + key->name;
      const std::string full = name.empty() ? key->name : name + "." + key->name;
      const bool is_table = key->type == Key::Type::table || key->type == Key::Type::tables;
      const auto found = table.find(key->name);
      if (is_table && found != table.end()) {
        SettingsNode& inner = found->second;
        if (inner.is_table()) {
          try_table(file, root, std::get<SettingsNode::Table>(inner.value), key->keys, id, full);
        } else {
          size_t i = 0;
          for (SettingsNode& item : std::get<SettingsNode::Array>(inner.value)) {
            try_table(file, root, std::get<SettingsNode::Table>(item.value), key->keys, id,
                      full + "[" + std::to_string(i++) + "]");
          }
        }
      }
      if (!agreed_.contains(id)) try_key(file, root, table, *key, id, full);
    }
  }

  // The keys that are known in the table, with the words that brought them.
  static std::vector<std::pair<const Key*, std::string>> with_choices(
      const SettingsNode::Table& table, const std::vector<Key>& keys, const std::string& path) {
    std::vector<std::pair<const Key*, std::string>> all;
    for (const Key& key : keys) {
      all.emplace_back(&key, path);
      const auto written = table.find(key.name);
      const SettingsNode* node = written != table.end() ? &written->second
                                 : key.otherwise        ? &*key.otherwise
                                                        : nullptr;
      if (node == nullptr || key.choices.empty()) continue;
      for (const Key::Choice& choice : key.choices) {
        if (choice.name != std::get<std::string>(node->value)) continue;
        for (auto& one : with_choices(table, choice.keys, path + "(" + choice.name + ")")) {
          all.push_back(std::move(one));
        }
      }
    }
    return all;
  }

  void try_key(const std::filesystem::path& file, SettingsNode& root, SettingsNode::Table& table,
               const Key& key, const std::string& id, const std::string& full) {
    // In its place, whatever unit it was written in.
    SettingsNode::Table before = table;
    std::erase_if(table, [&](const auto& item) { return is_same_quantity(item.first, key.name); });
    table[key.name] = of_wrong_type(key);
    const std::string message = all_of(checked(file, root, KeyCheck::by_readers));
    table = std::move(before);
    tried_[id] = message.empty() ? "nothing was message" : message;
    // A value that a reader accepts is known to it.
    const bool taken = key.type == Key::Type::other && message.empty();
    if (taken || agrees(message, key, full)) agreed_.insert(id);
  }

  static bool agrees(const std::string& message, const Key& key, const std::string& full) {
    constexpr size_t longest = 180;  // of what an error shows
    std::string expected = expected_of(key);
    if (key.range_varies) expected = expected.substr(0, expected.find_first_of("0123456789<>[(\""));
    const std::string line = full + ": found " + describe(of_wrong_type(key)) + ", expected ";
    if (key.type == Key::Type::other) return message.find(": " + full) != std::string::npos;
    if (key.type == Key::Type::table || key.type == Key::Type::tables) {
      return message.find(": " + line + "a table") != std::string::npos ||
             message.find(": " + line + "tables [[") != std::string::npos;
    }
    const size_t at = message.find(": " + line + expected.substr(0, longest));
    if (at == std::string::npos) return false;
    // And nothing beyond.
    const std::string rest =
        message.substr(at + 2 + line.size() + std::min(expected.size(), longest));
    return key.range_varies || expected.size() > longest || rest.starts_with("\n");
  }

  const std::vector<Key>& tables_;
  std::map<std::string, std::string> tried_;
  std::set<std::string> agreed_;
};

// The ids that Readers gives, of every key that is declared.
inline void ids_of(const std::vector<Key>& keys, const std::string& path,
                   std::set<std::string>& ids) {
  for (const Key& key : keys) {
    ids.insert(path + "." + key.name);
    ids_of(key.keys, path + "." + key.name, ids);
    for (const Key::Choice& choice : key.choices) {
      ids_of(choice.keys, path + "(" + choice.name + ")", ids);
    }
  }
}

}  // namespace photorque
