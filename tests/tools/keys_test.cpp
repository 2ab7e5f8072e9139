// The declared keys against the readers.
//
// tests/data/keys uses every key. With one key at a time set to a value of the wrong type the
// readers' own message must be what the declaration says: every declared key is read, with its
// type, unit and range.
#include "tools/keys/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "tests/tools/key_agreement.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::Not;

const std::vector<Key>& declared() {
  static const std::vector<Key> tables = experiment_keys();
  return tables;
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

TEST(Keys, OfTheExamplesAreDeclaredAndRead) {
  for (const fs::path& file : example_files()) {
    for (const KeyCheck check : {KeyCheck::by_declaration, KeyCheck::by_readers}) {
      EXPECT_EQ(all_of(checked(file, parsed(file), check)), "") << file;
    }
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
  EXPECT_THAT(disagreements(changed("topology", [](Key& k) { k.choices.pop_back(); })),
              Not(IsEmpty()));
}

TEST(Keys, AreEachExplained) {
  const std::function<void(const std::vector<Key>&)> explained = [&](const std::vector<Key>& keys) {
    for (const Key& key : keys) {
      EXPECT_FALSE(key.what.empty()) << key.name;
      EXPECT_FALSE(key.what.ends_with('.')) << key.name << ": " << key.what;
      EXPECT_FALSE(key.required && (key.otherwise || !key.usually.empty())) << key.name;
      explained(key.keys);
      for (const Key::Choice& choice : key.choices) explained(choice.keys);
    }
  };
  explained(declared());
}

}  // namespace

}  // namespace photorque
