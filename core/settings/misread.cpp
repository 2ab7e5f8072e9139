// Errors in the keys of a file, from the declarations of the keys alone.
#include <algorithm>

#include "core/settings/keys.h"
#include "core/settings/read_log.h"

namespace photorque {
namespace {

class Misreading {
 public:
  std::vector<InputError> of_table(const SettingsNode& node, const std::vector<Key>& keys,
                                   const std::string& name) {
    table(node, keys, name);
    return std::move(errors_);
  }

 private:
  void table(const SettingsNode& node, const std::vector<Key>& keys, const std::string& name) {
    const auto& written = std::get<SettingsNode::Table>(node.value);
    const std::vector<const Key*> known = keys_in(written, keys);
    for (const auto& [key, value] : written) {
      const std::string full = name.empty() ? key : name + "." + key;
      if (const Key* declared = find(known, key)) {
        check(value, *declared, key, full);
      } else if (is_chosen(written, known)) {
        refuse(value, known, key, full);
      } else if (const auto possible = of_every_choice(keys); find(possible, key) == nullptr) {
        // No choice of the kind has such a key.
        refuse(value, possible, key, full);
      } else {
        check_as_any(value, possible, key, full);
      }
    }
  }

  // All keys that a table may have, with any choices.
  static std::vector<const Key*> of_every_choice(const std::vector<Key>& keys) {
    std::vector<const Key*> all;
    for (const Key& key : keys) {
      all.push_back(&key);
      for (const Key::Choice& choice : key.choices) {
        const std::vector<const Key*> brought = of_every_choice(choice.keys);
        all.insert(all.end(), brought.begin(), brought.end());
      }
    }
    return all;
  }

  // Reports a value that no choice accepts: it is wrong whatever the choice.
  void check_as_any(const SettingsNode& value, const std::vector<const Key*>& possible,
                    const std::string& key, const std::string& full) {
    std::vector<InputError> first;
    for (const Key* one : possible) {
      if (find({one}, key) == nullptr) continue;
      Misreading as_one;
      as_one.check(value, *one, key, full);
      if (as_one.errors_.empty()) return;
      if (first.empty()) first = std::move(as_one.errors_);
    }
    errors_.insert(errors_.end(), first.begin(), first.end());
  }

  // Whether the table states every choice that has further keys, so that all its keys are known.
  static bool is_chosen(const SettingsNode::Table& written, const std::vector<const Key*>& known) {
    return std::ranges::all_of(known, [&](const Key* key) {
      const auto brings = [](const Key::Choice& choice) { return !choice.keys.empty(); };
      if (std::ranges::none_of(key->choices, brings)) return true;
      const auto node = written.find(key->name);
      if (node == written.end()) return key->otherwise.has_value();
      const auto* word = std::get_if<std::string>(&node->second.value);
      return word != nullptr &&
             std::ranges::find(key->choices, *word, &Key::Choice::name) != key->choices.end();
    });
  }

  static const Key* find(const std::vector<const Key*>& known, const std::string& key) {
    const KeyUnit unit = unit_of_key(key);
    const auto same_quantity = [&](const Key* one) {
      if (one->name == key) return true;
      const KeyUnit other = unit_of_key(one->name);
      return !unit.unit.empty() && other.stem == unit.stem && other.dimension == unit.dimension;
    };
    const auto exact = std::ranges::find_if(known, [&](const Key* k) { return k->name == key; });
    if (exact != known.end()) return *exact;
    const auto found = std::ranges::find_if(known, same_quantity);
    return found == known.end() ? nullptr : *found;
  }

  void refuse(const SettingsNode& value, const std::vector<const Key*>& known,
              const std::string& key, const std::string& full) {
    std::set<std::string> names;
    const std::string stem = unit_of_key(key).stem;
    for (const Key* one : known) {
      names.insert(one->name);
      const KeyUnit unit = unit_of_key(one->name);
      if (!unit.unit.empty() && unit.stem == stem) {
        errors_.emplace_back(value.where, full, "a key without a unit of " + unit.dimension,
                             "the key " + one->name);
        return;
      }
    }
    errors_.emplace_back(value.where, full, "an unknown key",
                         names.empty() ? "no keys here" : expected_keys(key, names));
  }

  // An element that is not a number is named rather than its array of three.
  void vector(const SettingsNode& value, const Key& key, const std::string& full) {
    const auto wrong = std::ranges::find_if_not(items(value), &SettingsNode::is_number);
    if (items(value).size() != 3 || wrong == items(value).end()) {
      return expect(is_vector(value), value, key, full);
    }
    errors_.emplace_back(wrong->where,
                         full + "[" + std::to_string(wrong - items(value).begin()) + "]",
                         describe(*wrong), "a number");
  }

  void expect(bool is_so, const SettingsNode& value, const Key& key, const std::string& full) {
    if (!is_so) errors_.emplace_back(value.where, full, describe(value), expected_of(key));
  }

  void check(const SettingsNode& value, const Key& key, const std::string& written,
             const std::string& full) {
    if (key.has_error && value.is_table()) {
      const auto& pair = std::get<SettingsNode::Table>(value.value);
      for (const auto& [part, number] : pair) {
        if (part == "value" || part == "sigma") continue;
        errors_.emplace_back(number.where, full + "." + part, "an unknown key",
                             expected_keys(part, {"value", "sigma"}));
      }
      if (const auto nominal = pair.find("value"); nominal != pair.end()) {
        plain(nominal->second, key, written, full + ".value");
      }
      return;
    }
    plain(value, key, written, full);
  }

  void plain(const SettingsNode& value, const Key& key, const std::string& written,
             const std::string& full) {
    switch (key.type) {
      case Key::Type::number:
        if (!key.or_array || !value.is_array()) {
          number(value, key, written, full);
          break;
        }
        [[fallthrough]];
      case Key::Type::numbers:
        expect(value.is_array() && (key.size == 0 || items(value).size() == key.size), value, key,
               full);
        for (const SettingsNode& item : items(value)) number(item, key, written, full);
        break;
      case Key::Type::integer:
        expect(is_whole(value, key), value, key, full);
        break;
      case Key::Type::flag:
        expect(std::holds_alternative<bool>(value.value), value, key, full);
        break;
      case Key::Type::text:
        expect(is_text(value), value, key, full);
        break;
      case Key::Type::texts:
        expect(value.is_array() && std::ranges::all_of(items(value), is_text), value, key, full);
        break;
      case Key::Type::choice:
        choice(value, key, full);
        break;
      case Key::Type::vector:
        vector(value, key, full);
        break;
      case Key::Type::vectors:
        expect(!items(value).empty() && std::ranges::all_of(items(value), is_vector), value, key,
               full);
        break;
      case Key::Type::table:
        expect(value.is_table(), value, key, full);
        if (value.is_table()) table(value, key.keys, full);
        break;
      case Key::Type::tables:
        tables(value, key, full);
        break;
      case Key::Type::other:
        expect((form_of(value) & key.forms) != 0, value, key, full);
        break;
    }
  }

  void number(const SettingsNode& value, const Key& key, const std::string& written,
              const std::string& full) {
    // The number in the user's unit, as the readers print it.
    const KeyUnit unit = unit_of_key(written);
    const auto* whole = std::get_if<int64_t>(&value.value);
    const auto* real = std::get_if<double>(&value.value);
    const double x = whole != nullptr ? static_cast<double>(*whole) : real != nullptr ? *real : 0.0;
    if ((whole == nullptr && real == nullptr) || !is_inside(x * unit.to_SI, key.range)) {
      const KeyUnit declared = unit_of_key(key.name);
      errors_.emplace_back(
          value.where, full, describe(value),
          describe_range(key.range, unit.to_SI, declared.unit.empty() ? "" : unit.unit));
    }
  }

  void choice(const SettingsNode& value, const Key& key, const std::string& full) {
    const auto* word = std::get_if<std::string>(&value.value);
    std::vector<std::string> names;
    for (const Key::Choice& one : key.choices) names.push_back(one.name);
    if (word == nullptr) {
      expect(false, value, key, full);
    } else if (std::ranges::find(names, *word) == names.end()) {
      errors_.emplace_back(value.where, full, describe(value), one_of(names, *word));
    }
  }

  void tables(const SettingsNode& value, const Key& key, const std::string& full) {
    if (value.is_table()) return table(value, key.keys, full);
    expect(value.is_array(), value, key, full);
    size_t i = 0;
    for (const SettingsNode& item : items(value)) {
      const std::string name = full + "[" + std::to_string(i++) + "]";
      if (item.is_table()) {
        table(item, key.keys, name);
      } else {
        errors_.emplace_back(item.where, name, describe(item), "a table");
      }
    }
  }

  static const SettingsNode::Array& items(const SettingsNode& value) {
    static const SettingsNode::Array none;
    const auto* array = std::get_if<SettingsNode::Array>(&value.value);
    return array == nullptr ? none : *array;
  }
  static bool is_text(const SettingsNode& value) {
    return std::holds_alternative<std::string>(value.value);
  }
  static bool is_vector(const SettingsNode& value) {
    const SettingsNode::Array& three = items(value);
    return three.size() == 3 &&
           std::ranges::all_of(three, [](const SettingsNode& x) { return x.is_number(); });
  }
  static bool is_whole(const SettingsNode& value, const Key& key) {
    if (const auto* whole = std::get_if<int64_t>(&value.value)) {
      return *whole >= key.low && *whole <= key.high;
    }
    const auto* real = std::get_if<double>(&value.value);
    return real != nullptr && std::abs(*real) < 0x1p53 && *real == std::floor(*real) &&
           *real >= static_cast<double>(key.low) && *real <= static_cast<double>(key.high);
  }
  static unsigned form_of(const SettingsNode& value) {
    if (value.is_number()) return Key::a_number;
    if (value.is_array()) return Key::an_array;
    if (value.is_table()) return Key::a_table;
    // Dates are read as text.
    return is_text(value) ? unsigned{Key::a_text} | Key::a_date : unsigned{Key::a_flag};
  }

  std::vector<InputError> errors_;
};

}  // namespace

std::vector<InputError> misread_keys(const SettingsNode& table, const std::vector<Key>& keys,
                                     const std::string& name) {
  return Misreading().of_table(table, keys, name);
}

}  // namespace photorque
