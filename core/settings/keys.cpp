#include "core/settings/keys.h"

#include <algorithm>
#include <cmath>

#include "core/settings/read_log.h"

namespace photorque {
namespace {

// Without the last bits that a conversion of units leaves: 1.8 and not 1.8000000000000003.
double rounded(double x) {
  return std::isfinite(x) ? std::stod(format_setting(x)) : x;
}

Key key_of(Key::Type type, std::string name, std::string what) {
  Key key;
  key.name = std::move(name);
  key.type = type;
  key.what = std::move(what);
  return key;
}

Key with_default(Key key, SettingsNode otherwise) {
  key.required = false;
  key.otherwise = std::move(otherwise);
  return key;
}

}  // namespace

Key Key::number(std::string name, Range range, std::string what) {
  Key key = key_of(Type::number, std::move(name), std::move(what));
  key.range = range;
  return key;
}

Key Key::number_or(std::string name, double otherwise_SI, Range range, std::string what) {
  const double factor = unit_of_key(name).to_SI;
  return with_default(number(std::move(name), range, std::move(what)),
                      {rounded(otherwise_SI / factor)});
}

Key Key::uncertain(std::string name, Range range, std::string what) {
  return number(std::move(name), range, std::move(what)).with_error();
}

Key Key::uncertain_or(std::string name, double otherwise_SI, Range range, std::string what) {
  return number_or(std::move(name), otherwise_SI, range, std::move(what)).with_error();
}

Key Key::uncertain_vector(std::string name, std::string what) {
  return vector3(std::move(name), std::move(what)).with_error();
}

Key Key::integer(std::string name, int64_t low, int64_t high, std::string what) {
  Key key = key_of(Type::integer, std::move(name), std::move(what));
  key.low = low;
  key.high = high;
  return key;
}

Key Key::integer_or(std::string name, int64_t otherwise, int64_t low, int64_t high,
                    std::string what) {
  return with_default(integer(std::move(name), low, high, std::move(what)), {otherwise});
}

Key Key::flag_or(std::string name, bool otherwise, std::string what) {
  return with_default(key_of(Type::flag, std::move(name), std::move(what)), {otherwise});
}

Key Key::text(std::string name, std::string what) {
  return key_of(Type::text, std::move(name), std::move(what));
}

Key Key::text_or(std::string name, std::string otherwise, std::string what) {
  return with_default(text(std::move(name), std::move(what)), {std::move(otherwise)});
}

Key Key::choice(std::string name, std::vector<Choice> choices, std::string what) {
  Key key = key_of(Type::choice, std::move(name), std::move(what));
  key.choices = std::move(choices);
  return key;
}

Key Key::choice_or(std::string name, std::vector<Choice> choices, size_t otherwise,
                   std::string what) {
  const std::string usual = choices.at(otherwise).name;
  return with_default(choice(std::move(name), std::move(choices), std::move(what)), {usual});
}

Key Key::vector3(std::string name, std::string what) {
  return key_of(Type::vector, std::move(name), std::move(what));
}

Key Key::vector3_or(std::string name, const Vec3& otherwise_SI, std::string what) {
  const Vec3 written = otherwise_SI / unit_of_key(name).to_SI;
  return with_default(
      vector3(std::move(name), std::move(what)),
      {SettingsNode::Array{{rounded(written[0])}, {rounded(written[1])}, {rounded(written[2])}}});
}

Key Key::vectors3(std::string name, std::string what) {
  return key_of(Type::vectors, std::move(name), std::move(what));
}

Key Key::numbers(std::string name, Range range, std::string what) {
  Key key = key_of(Type::numbers, std::move(name), std::move(what));
  key.range = range;
  return key;
}

Key Key::texts(std::string name, std::string what) {
  return key_of(Type::texts, std::move(name), std::move(what));
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

Key Key::other(std::string name, unsigned forms, std::string what) {
  Key key = key_of(Type::other, std::move(name), std::move(what));
  key.forms = forms;
  return key;
}

Key Key::optional() && {
  required = false;
  return std::move(*this);
}

Key Key::usually_is(std::string words) && {
  required = false;
  usually = std::move(words);
  return std::move(*this);
}

Key Key::that_completes() && {
  required = false;
  completes = true;
  return std::move(*this);
}

Key Key::with_error() && {
  has_error = true;
  return std::move(*this);
}

Key Key::one_or_several() && {
  or_array = true;
  return std::move(*this);
}

Key Key::of_size(size_t count) && {
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
