// One constant for each key: its reader, the schema and the documents share it.
//
//   constexpr NumberKey tilt{"tilt_deg", 0.0, {0.0, pi}, "the body's z axis leans by this"};
//
//   settings.get(tilt)            its value in SI; the default where the user did not write it
//   settings.has(tilt)            a key is its name where a name is expected
//   Key::table("attitude", {tilt, heading}, "how the platform stands")      declares both
//
// Defaults and ranges are SI. A key without a default is required, unless it is optional() or
// usually() something that is no constant: then it is read by get_or(), or by get() behind has().
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// What keys of all types have.
template <class Self>
struct TypedKey {
  std::string_view name, what;
  bool required = true;
  std::string_view usual = {};  // the default in words, where it is no constant
  bool completes = false;       // see Key, as for all of these
  bool has_error = false;
  bool range_varies = false;

  constexpr operator std::string_view() const { return name; }

  constexpr Self optional() const {
    return changed([](Self& key) { key.required = false; });
  }
  constexpr Self usually(std::string_view words) const {
    return changed([words](Self& key) {
      key.required = false;
      key.usual = words;
    });
  }
  // The same key where its meaning is another.
  constexpr Self meaning(std::string_view sentence) const {
    return changed([sentence](Self& key) { key.what = sentence; });
  }
  constexpr Self that_completes() const {
    return changed([](Self& key) {
      key.required = false;
      key.completes = true;
    });
  }
  constexpr Self with_error() const {
    return changed([](Self& key) { key.has_error = true; });
  }
  // The reader's depends on other keys: get(key.within(…)).
  constexpr Self range_that_varies() const {
    return changed([](Self& key) { key.range_varies = true; });
  }

 protected:
  constexpr TypedKey(std::string_view key, std::string_view sentence) : name(key), what(sentence) {}
  template <class Change>
  constexpr Self changed(Change change) const {
    Self copy = static_cast<const Self&>(*this);
    change(copy);
    return copy;
  }
  // The same in the declaration.
  Key declared(Key key) const {
    key.required = key.required && required;
    key.usually = usual;
    key.completes = completes;
    key.has_error = key.has_error || has_error;
    key.range_varies = range_varies;
    return key;
  }
};

struct NumberKey : TypedKey<NumberKey> {
  std::optional<double> otherwise;
  Range range;
  bool or_array = false;

  constexpr NumberKey(std::string_view key, Range admitted, std::string_view sentence)
      : TypedKey(key, sentence), range(admitted) {}
  constexpr NumberKey(std::string_view key, double otherwise_SI, Range admitted,
                      std::string_view sentence)
      : TypedKey(key, sentence), otherwise(otherwise_SI), range(admitted) {}
  // May be an array of them; get() reads one, Settings::numbers() several.
  constexpr NumberKey one_or_several() const {
    return changed([](NumberKey& key) { key.or_array = true; });
  }
  constexpr NumberKey with_default(double otherwise_SI) const {
    return changed([otherwise_SI](NumberKey& key) { key.otherwise = otherwise_SI; });
  }
  constexpr NumberKey within(Range admitted) const {
    return changed([admitted](NumberKey& key) { key.range = admitted; });
  }

  double read(const Settings& settings) const {
    return otherwise ? settings.number_or(name, *otherwise, range) : settings.number(name, range);
  }
  operator Key() const;
};

// A number that may have a sigma.
struct UncertainNumberKey : TypedKey<UncertainNumberKey> {
  std::optional<Uncertain> otherwise;
  Range range;

  constexpr UncertainNumberKey(std::string_view key, Range admitted, std::string_view sentence)
      : TypedKey(key, sentence), range(admitted) {}
  constexpr UncertainNumberKey(std::string_view key, Uncertain otherwise_SI, Range admitted,
                               std::string_view sentence)
      : TypedKey(key, sentence), otherwise(otherwise_SI), range(admitted) {}

  Uncertain read(const Settings& settings) const {
    return otherwise && !settings.has(name) ? *otherwise : settings.uncertain(name, range);
  }
  operator Key() const;
};

struct IntegerKey : TypedKey<IntegerKey> {
  std::optional<int64_t> otherwise;
  int64_t low, high;

  constexpr IntegerKey(std::string_view key, int64_t least, int64_t most, std::string_view sentence)
      : TypedKey(key, sentence), low(least), high(most) {}
  constexpr IntegerKey(std::string_view key, int64_t usual_value, int64_t least, int64_t most,
                       std::string_view sentence)
      : TypedKey(key, sentence), otherwise(usual_value), low(least), high(most) {}
  constexpr IntegerKey with_default(int64_t usual_value) const {
    return changed([usual_value](IntegerKey& key) { key.otherwise = usual_value; });
  }
  constexpr IntegerKey within(int64_t least, int64_t most) const {
    return changed([least, most](IntegerKey& key) {
      key.low = least;
      key.high = most;
    });
  }

  int64_t read(const Settings& settings) const {
    return otherwise ? settings.integer_or(name, *otherwise, low, high)
                     : settings.integer(name, low, high);
  }
  operator Key() const;
};

struct FlagKey : TypedKey<FlagKey> {
  bool otherwise;

  constexpr FlagKey(std::string_view key, bool usual_value, std::string_view sentence)
      : TypedKey(key, sentence), otherwise(usual_value) {}

  bool read(const Settings& settings) const { return settings.flag_or(name, otherwise); }
  operator Key() const;
};

struct TextKey : TypedKey<TextKey> {
  std::optional<std::string_view> otherwise;

  constexpr TextKey(std::string_view key, std::string_view sentence) : TypedKey(key, sentence) {}
  constexpr TextKey(std::string_view key, std::string_view usual_value, std::string_view sentence)
      : TypedKey(key, sentence), otherwise(usual_value) {}
  constexpr TextKey with_default(std::string_view text) const {
    return changed([text](TextKey& key) { key.otherwise = text; });
  }

  std::string read(const Settings& settings) const {
    return otherwise ? settings.text_or(name, *otherwise) : settings.text(name);
  }
  operator Key() const;
};

struct TextsKey : TypedKey<TextsKey> {
  constexpr TextsKey(std::string_view key, std::string_view sentence) : TypedKey(key, sentence) {}

  std::vector<std::string> read(const Settings& settings) const { return settings.texts(name); }
  operator Key() const;
};

// A word of a choice.
struct Word {
  std::string_view name, what;

  constexpr Word(const char* word, const char* sentence = "") : name(word), what(sentence) {}
};

// One word of several, read as its index.
template <size_t count>
struct ChoiceKey : TypedKey<ChoiceKey<count>> {
  std::array<Word, count> words;
  std::optional<size_t> otherwise;

  constexpr ChoiceKey(std::string_view key, const Word (&all)[count], std::string_view sentence)
      : TypedKey<ChoiceKey>(key, sentence), words(std::to_array(all)) {}
  constexpr ChoiceKey(std::string_view key, const Word (&all)[count], size_t usual_word,
                      std::string_view sentence)
      : TypedKey<ChoiceKey>(key, sentence), words(std::to_array(all)), otherwise(usual_word) {}
  constexpr ChoiceKey with_default(size_t word) const {
    return this->changed([word](ChoiceKey& key) { key.otherwise = word; });
  }

  size_t read(const Settings& settings) const {
    std::vector<std::string> names;
    for (const Word& word : words) names.emplace_back(word.name);
    return otherwise ? settings.choice_or(this->name, names, *otherwise)
                     : settings.choice(this->name, names);
  }
  // Declares it with the keys that a table has beside each word, in the words' order.
  Key bringing(const std::vector<std::vector<Key>>& keys) const {
    std::vector<Key::Choice> choices;
    for (size_t i = 0; i < count; ++i) {
      choices.push_back({std::string(words[i].name), std::string(words[i].what),
                         i < keys.size() ? keys[i] : std::vector<Key>{}});
    }
    std::string key(this->name), sentence(this->what);
    return this->declared(otherwise ? Key::choice_or(key, choices, *otherwise, sentence)
                                    : Key::choice(key, choices, sentence));
  }
  operator Key() const { return bringing({}); }
};

// Three numbers.
struct Vec3Key : TypedKey<Vec3Key> {
  std::optional<std::array<double, 3>> otherwise;

  constexpr Vec3Key(std::string_view key, std::string_view sentence) : TypedKey(key, sentence) {}
  constexpr Vec3Key(std::string_view key, const std::array<double, 3>& otherwise_SI,
                    std::string_view sentence)
      : TypedKey(key, sentence), otherwise(otherwise_SI) {}

  Vec3 read(const Settings& settings) const {
    return otherwise ? settings.vector3_or(name, Vec3(otherwise->data())) : settings.vector3(name);
  }
  operator Key() const;
};

// An array of three numbers each.
struct Vec3sKey : TypedKey<Vec3sKey> {
  constexpr Vec3sKey(std::string_view key, std::string_view sentence) : TypedKey(key, sentence) {}

  std::vector<Vec3> read(const Settings& settings) const { return settings.vectors3(name); }
  operator Key() const;
};

// An array of numbers.
struct NumbersKey : TypedKey<NumbersKey> {
  Range range;
  size_t size = 0;  // 0: any

  constexpr NumbersKey(std::string_view key, Range admitted, std::string_view sentence)
      : TypedKey(key, sentence), range(admitted) {}
  constexpr NumbersKey of_size(size_t numbers) const {
    return changed([numbers](NumbersKey& key) { key.size = numbers; });
  }

  std::vector<double> read(const Settings& settings) const { return settings.numbers(name, range); }
  operator Key() const;
};

// What its reader takes apart by itself; `forms` as Key::Form.
struct OtherKey : TypedKey<OtherKey> {
  unsigned forms;

  constexpr OtherKey(std::string_view key, unsigned all, std::string_view sentence)
      : TypedKey(key, sentence), forms(all) {}

  const SettingsNode& read(const Settings& settings) const { return settings.raw(name); }
  operator Key() const;
};

// A table below this one, declared with its keys.
struct TableKey : TypedKey<TableKey> {
  constexpr TableKey(std::string_view key, std::string_view sentence) : TypedKey(key, sentence) {}

  Settings read(const Settings& settings) const { return settings.table(name); }
  Key of(std::vector<Key> keys) const;
};

// An array of tables.
struct TablesKey : TypedKey<TablesKey> {
  constexpr TablesKey(std::string_view key, std::string_view sentence) : TypedKey(key, sentence) {}

  std::vector<Settings> read(const Settings& settings) const { return settings.tables(name); }
  Key of(std::vector<Key> keys) const;
};

}  // namespace photorque
