#include "core/settings/keys.h"

#include <algorithm>

#include "core/settings/read_log.h"

namespace photorque {
namespace {

Key key_of(Key::Type type, std::string name, std::string what) {
  Key key;
  key.name = std::move(name);
  key.type = type;
  key.what = std::move(what);
  return key;
}

}  // namespace

Key Key::choice(std::string name, std::vector<Choice> choices, std::string what) {
  Key key = key_of(Type::choice, std::move(name), std::move(what));
  key.choices = std::move(choices);
  return key;
}

Key Key::choice_or(std::string name, std::vector<Choice> choices, size_t otherwise,
                   std::string what) {
  const std::string usual = choices.at(otherwise).name;
  Key key = choice(std::move(name), std::move(choices), std::move(what));
  key.required = false;
  key.otherwise = SettingsNode{usual};
  return key;
}

Key Key::table(std::string name, std::vector<Key> keys, std::string what) {
  Key key = key_of(Type::table, std::move(name), std::move(what));
  key.required = false;
  key.keys = std::move(keys);
  return key;
}

Key Key::tables(std::string name, std::vector<Key> keys, std::string what) {
  Key key = table(std::move(name), std::move(keys), std::move(what));
  key.type = Type::tables;
  return key;
}

Key Key::optional() && {
  required = false;
  return std::move(*this);
}

Key Key::with_default_text(std::string words) && {
  required = false;
  usually = std::move(words);
  return std::move(*this);
}

Key Key::one_or_several(size_t count) && {
  or_array = true;
  size = count;
  return std::move(*this);
}

Key Key::range_that_varies() && {
  range_varies = true;
  return std::move(*this);
}

std::vector<Key> joined(std::initializer_list<std::vector<Key>> lists) {
  std::vector<Key> all;
  for (const std::vector<Key>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

std::vector<Key::Choice> words(std::initializer_list<const char*> names) {
  std::vector<Key::Choice> all;
  for (const char* name : names) all.push_back({name});
  return all;
}

void add_choice(std::vector<Key::Choice>& choices, Key::Choice added) {
  const auto same = std::ranges::find(choices, added.name, &Key::Choice::name);
  if (same == choices.end()) {
    choices.push_back(std::move(added));
    return;
  }
  const auto lacks = [](const std::vector<Key>& keys, const std::string& name) {
    return std::ranges::find(keys, name, &Key::name) == keys.end();
  };
  for (Key& key : same->keys) {
    if (lacks(added.keys, key.name)) key.required = false;
  }
  for (Key& key : added.keys) {
    if (!lacks(same->keys, key.name)) continue;
    key.required = false;
    same->keys.push_back(std::move(key));
  }
}

std::string expected_of(const Key& key) {
  const KeyUnit unit = unit_of_key(key.name);
  switch (key.type) {
    case Key::Type::number:
      return describe_range(key.range, unit.to_SI, unit.unit);
    case Key::Type::numbers:
      return "an array of numbers";
    case Key::Type::integer:
      return "a whole number from " + std::to_string(key.low) + " to " + std::to_string(key.high);
    case Key::Type::flag:
      return "true or false";
    case Key::Type::text:
      return "a text in quotes";
    case Key::Type::texts:
      return "an array of texts";
    case Key::Type::choice: {
      std::vector<std::string> names;
      for (const Key::Choice& choice : key.choices) names.push_back(choice.name);
      return one_of(names);
    }
    case Key::Type::vector:
      return "an array of 3 numbers";
    case Key::Type::vectors:
      return "an array of arrays of 3 numbers";
    case Key::Type::table:
      return "a table";
    case Key::Type::tables:
      return "tables [[" + key.name + "]]";
    case Key::Type::other:
      break;
  }
  std::string forms;
  const auto add = [&](unsigned form, const char* words) {
    if ((key.forms & form) != 0) forms += (forms.empty() ? "" : " or ") + std::string(words);
  };
  add(Key::a_number, "a number");
  add(Key::a_flag, "true or false");
  add(Key::a_text, "a text in quotes");
  add(Key::a_date, "a date");
  add(Key::an_array, "an array");
  add(Key::a_table, "a table");
  return forms;
}

std::vector<const Key*> keys_in(const SettingsNode::Table& table, const std::vector<Key>& keys) {
  std::vector<const Key*> all;
  for (const Key& key : keys) {
    all.push_back(&key);
    if (key.type != Key::Type::choice) continue;
    const auto written = table.find(key.name);
    const SettingsNode* node = written != table.end() ? &written->second
                               : key.otherwise        ? &*key.otherwise
                                                      : nullptr;
    const auto* word = node == nullptr ? nullptr : std::get_if<std::string>(&node->value);
    if (word == nullptr) continue;
    for (const Key::Choice& choice : key.choices) {
      if (choice.name != *word) continue;
      const std::vector<const Key*> brought = keys_in(table, choice.keys);
      all.insert(all.end(), brought.begin(), brought.end());
    }
  }
  return all;
}

}  // namespace photorque
