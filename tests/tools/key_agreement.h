// What holds the declared keys against their readers: for keys_test.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/files.h"
#include "core/settings/keys.h"
#include "scenes/experiment/toml_reader.h"
#include "scenes/experiment/toml_writer.h"
#include "tools/tasks/check.h"

namespace photorque {

inline const std::filesystem::path examples =
    std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "tests/data/keys";

// A key that a reader asked for, in a table as it was written.
struct Asked {
  std::string table, key;
  SettingsNode::Table written;
  std::optional<SettingsNode> otherwise_SI;
};

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
  return check_experiment(options, keys);
}

inline std::string all_of(const CheckReport& report) {
  std::string lines;
  for (const InputError& mistake : report.mistakes) lines += std::string(mistake.what()) + "\n";
  return lines;
}

// "source[0].back" → {"source", "back"}.
inline std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> parts = {""};
  bool in_brackets = false;
  for (const char c : name) {
    if (c == '[') in_brackets = true;
    if (c == '.') {
      parts.emplace_back();
    } else if (!in_brackets) {
      parts.back() += c;
    }
    if (c == ']') in_brackets = false;
  }
  return parts;
}

inline bool is_same_quantity(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const KeyUnit x = unit_of_key(a), y = unit_of_key(b);
  return !x.unit.empty() && x.stem == y.stem && x.dimension == y.dimension;
}

inline const Key* among(const std::vector<const Key*>& keys, const std::string& name) {
  const auto exact = std::ranges::find_if(keys, [&](const Key* k) { return k->name == name; });
  if (exact != keys.end()) return *exact;
  const auto it =
      std::ranges::find_if(keys, [&](const Key* k) { return is_same_quantity(k->name, name); });
  return it == keys.end() ? nullptr : *it;
}

// Every key of a list, whatever choice brings it.
inline void flatten(const std::vector<Key>& keys, std::vector<const Key*>& all) {
  for (const Key& key : keys) {
    all.push_back(&key);
    for (const Key::Choice& choice : key.choices) flatten(choice.keys, all);
  }
}

// Where in the declarations a table of that name is; null where it is none that is declared (a
// copy of a reader's own, the parts of a value with its error).
inline const std::vector<Key>* keys_at(const std::vector<Key>& tables, const std::string& name) {
  const std::vector<Key>* keys = &tables;
  if (name.empty()) return keys;
  for (const std::string& part : parts_of(name)) {
    std::vector<const Key*> all;
    flatten(*keys, all);
    const Key* inner = nullptr;
    for (const Key* key : all) {
      if (key->name == part && !key->keys.empty()) inner = key;
    }
    if (inner == nullptr) return nullptr;
    keys = &inner->keys;
  }
  return keys;
}

inline double in_SI(const SettingsNode& number, double to_SI) {
  const auto* whole = std::get_if<int64_t>(&number.value);
  return (whole != nullptr ? static_cast<double>(*whole) : std::get<double>(number.value)) * to_SI;
}

inline bool is_same_default(const SettingsNode& declared, double to_SI,
                            const SettingsNode& otherwise_SI) {
  if (declared.is_number() && otherwise_SI.is_number()) {
    const double a = in_SI(declared, to_SI), b = in_SI(otherwise_SI, 1.0);
    return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
  }
  const auto* a = std::get_if<SettingsNode::Array>(&declared.value);
  const auto* b = std::get_if<SettingsNode::Array>(&otherwise_SI.value);
  if (a != nullptr && b != nullptr) {
    bool same = a->size() == b->size();
    for (size_t i = 0; same && i < a->size(); ++i) same = is_same_default((*a)[i], to_SI, (*b)[i]);
    return same;
  }
  return toml_value(declared) == toml_value(otherwise_SI);
}

// Who asks with an empty text for a default wants to know whether the key is there.
inline bool is_empty(const SettingsNode& otherwise) {
  const auto* text = std::get_if<std::string>(&otherwise.value);
  return text != nullptr && text->empty();
}

// What the readers ask for and the declarations do not know, or know with another default.
inline std::set<std::string> asked_amiss(const std::vector<Key>& tables,
                                         const std::vector<Asked>& all) {
  std::set<std::string> amiss;
  for (const Asked& asked : all) {
    const std::vector<Key>* keys = keys_at(tables, asked.table);
    if (keys == nullptr) continue;
    std::string table;
    for (const std::string& part : parts_of(asked.table)) table += part + ".";
    const Key* key = among(keys_in(asked.written, *keys), asked.key);
    // `budget` looks for bodies in the air in every disturbance.
    const bool is_part = asked.table.starts_with("disturbance[") && asked.key == "part";
    if (key == nullptr && is_part) continue;
    if (key == nullptr) {
      amiss.insert(table + asked.key + " is asked for");
    } else if (asked.otherwise_SI && !is_empty(*asked.otherwise_SI) && key->usually.empty() &&
               (!key->otherwise || !is_same_default(*key->otherwise, unit_of_key(key->name).to_SI,
                                                    *asked.otherwise_SI))) {
      amiss.insert(table + key->name + " has the default " + toml_value(*asked.otherwise_SI));
    }
  }
  return amiss;
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
    std::vector<std::string> choices;
    try_table(file, root, std::get<SettingsNode::Table>(root.value), tables_, "", "");
  }

  // Declared keys that no reader knows as they are declared.
  std::set<std::string> amiss() const {
    std::set<std::string> left;
    for (const auto& [key, said] : tried_) {
      if (!agreed_.contains(key)) left.insert(key + ": " + said);
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
    const std::string said = all_of(checked(file, root, KeyCheck::by_readers));
    table = std::move(before);
    tried_[id] = said.empty() ? "nothing was said" : said;
    // What a reader takes as it stands is known to it.
    const bool taken = key.type == Key::Type::other && said.empty();
    if (taken || agrees(said, key, full)) agreed_.insert(id);
  }

  static bool agrees(const std::string& said, const Key& key, const std::string& full) {
    constexpr size_t longest = 180;  // of what an error shows
    std::string expected = expected_of(key);
    if (key.range_varies) expected = expected.substr(0, expected.find_first_of("0123456789<>[(\""));
    const std::string line = full + ": found " + describe(of_wrong_type(key)) + ", expected ";
    if (key.type == Key::Type::other) return said.find(": " + full) != std::string::npos;
    if (key.type == Key::Type::table || key.type == Key::Type::tables) {
      return said.find(": " + line + "a table") != std::string::npos ||
             said.find(": " + line + "tables [[") != std::string::npos;
    }
    const size_t at = said.find(": " + line + expected.substr(0, longest));
    if (at == std::string::npos) return false;
    // And nothing beyond.
    const std::string rest = said.substr(at + 2 + line.size() + std::min(expected.size(), longest));
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
