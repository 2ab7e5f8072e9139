// The declared keys against the readers: what they ask for, expect and take by default.
//
// tests/data/keys uses every key. With one key at a time set to a value of the wrong type the
// readers' own message must be what the declaration says: so type, unit, range and words agree.
// note_asked() hears what they ask for besides.
#include "tools/keys/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/settings/read_log.h"
#include "tests/tools/key_agreement.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::Not;

std::vector<Asked>* listener = nullptr;  // while someone listens

const std::vector<Key>& declared() {
  static const std::vector<Key> tables = experiment_keys();
  return tables;
}

std::vector<Asked> asked_by_readers(const fs::path& file) {
  std::vector<Asked> all;
  listener = &all;
  const CheckReport report = checked(file, parsed(file), KeyCheck::by_readers);
  listener = nullptr;
  EXPECT_EQ(all_of(report), "") << file;
  return all;
}

TEST(Keys, AreTakenByTheReadersWithTheirTypesUnitsAndRanges) {
  Readers readers(declared());
  for (const fs::path& file : example_files()) readers.try_all(file);
  EXPECT_THAT(readers.amiss(), IsEmpty());
  std::set<std::string> all;
  ids_of(declared(), "", all);
  std::set<std::string> untried;
  for (const std::string& id : all) {
    if (!readers.agreed().contains(id)) untried.insert(id);
  }
  EXPECT_THAT(untried, IsEmpty());
  EXPECT_GT(all.size(), 700u);
}

TEST(Keys, AreAllThatTheReadersAskForWithTheirDefaults) {
  std::vector<fs::path> files = example_files();
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(PHOTORQUE_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() == ".toml" && entry.path().stem() != "parameters") {
      files.push_back(entry.path());
    }
  }
  size_t asked = 0;
  for (const fs::path& file : files) {
    const std::vector<Asked> all = asked_by_readers(file);
    asked += all.size();
    EXPECT_THAT(asked_amiss(declared(), all), IsEmpty()) << file;
  }
  EXPECT_GT(asked, 5000u);
}

TEST(Keys, OfTheExamplesAreDeclared) {
  for (const fs::path& file : example_files()) {
    EXPECT_EQ(all_of(checked(file, parsed(file), KeyCheck::by_declaration)), "") << file;
  }
}

// A kind that no example has would not be heard.
TEST(Keys, OfEveryKindHaveAnExample) {
  std::map<std::string, std::set<std::string>> found;
  for (const fs::path& file : example_files()) {
    const SettingsNode root = parsed(file);
    for (const auto& [name, node] : std::get<SettingsNode::Table>(root.value)) {
      const auto* items = std::get_if<SettingsNode::Array>(&node.value);
      if (items == nullptr) continue;
      for (const SettingsNode& item : *items) {
        const auto& table = std::get<SettingsNode::Table>(item.value);
        const auto kind = table.find("kind");
        if (kind != table.end()) found[name].insert(std::get<std::string>(kind->second.value));
      }
    }
  }
  for (const Key& table : declared()) {
    if (table.keys.empty() || table.keys.front().name != "kind") continue;
    for (const Key::Choice& kind : table.keys.front().choices) {
      EXPECT_TRUE(found[table.name].contains(kind.name)) << table.name << " " << kind.name;
    }
  }
}

// The tests above see every kind of disagreement.
TEST(Keys, ThatAreDeclaredWronglyAreFound) {
  const fs::path file = examples / "wheel.toml";
  const auto changed = [](const std::string& name, const std::function<void(Key&)>& change) {
    std::vector<Key> tables = experiment_keys();
    for (Key& table : tables) {
      if (table.name != "platform") continue;
      for (Key& key : table.keys) {
        if (key.name == name) change(key);
      }
    }
    return tables;
  };
  const auto disagreements = [&](const std::vector<Key>& tables) {
    Readers readers(tables);
    readers.try_all(file);
    std::set<std::string> all = readers.amiss();
    all.merge(asked_amiss(tables, asked_by_readers(file)));
    // The file has this table alone as it is meant.
    std::erase_if(all, [](const std::string& one) {
      return !one.starts_with("platform.") && !one.starts_with(".platform");
    });
    return all;
  };
  EXPECT_THAT(disagreements(declared()), IsEmpty());
  const std::string name = "battery_voltage_V";
  EXPECT_THAT(disagreements(changed(name, [](Key& k) { k.name = "battery_voltage_kV"; })),
              Not(IsEmpty()));
  EXPECT_THAT(disagreements(changed(name, [](Key& k) { k.name = "battery_tension_V"; })),
              Not(IsEmpty()));
  EXPECT_THAT(disagreements(changed(name, [](Key& k) { k.range = Range::not_negative(); })),
              Not(IsEmpty()));
  EXPECT_THAT(disagreements(changed(name, [](Key& k) { k.type = Key::Type::text; })),
              Not(IsEmpty()));
  EXPECT_THAT(disagreements(changed(name, [](Key& k) { k.otherwise = SettingsNode{12.0}; })),
              Not(IsEmpty()));
  EXPECT_THAT(disagreements(changed("topology", [](Key& k) { k.choices.pop_back(); })),
              Not(IsEmpty()));
}

TEST(Keys, AreEachExplained) {
  std::vector<const Key*> all;
  const std::function<void(const std::vector<Key>&)> collect = [&](const std::vector<Key>& keys) {
    std::vector<const Key*> here;
    flatten(keys, here);
    for (const Key* key : here) {
      all.push_back(key);
      collect(key->keys);
    }
  };
  collect(declared());
  for (const Key* key : all) {
    EXPECT_FALSE(key->what.empty()) << key->name;
    EXPECT_FALSE(key->what.ends_with('.')) << key->name << ": " << key->what;
    EXPECT_FALSE(key->required && (key->otherwise || !key->usually.empty())) << key->name;
  }
}

}  // namespace

// In the place of core's.
void note_asked(const SettingsNode& table, const std::string& name, std::string_view key,
                const SettingsNode* otherwise_SI) {
  if (listener == nullptr) return;
  listener->push_back({name, std::string(key), std::get<SettingsNode::Table>(table.value),
                       otherwise_SI == nullptr ? std::nullopt : std::optional(*otherwise_SI)});
}

}  // namespace photorque
