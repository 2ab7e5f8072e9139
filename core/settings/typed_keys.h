// Typed keys: one constant for each key, shared by its reader, the schema and the documents.
//
//   constexpr NumberKey tilt("tilt_deg", 0.0, {0.0, pi}, "the body's z axis leans by this");
//
//   settings.get(tilt)            its value in SI; the default if the user did not write it
//   settings.has(tilt)            a key converts to its name
//   Key::table("attitude", {tilt, heading}, "how the platform stands")      declares both
//
// Defaults and ranges are SI. A key without a default is required, unless its traits make it
// optional. An optional key is read by get_or(), or by get() after has().
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

// Further properties of a key: the members of Key.
struct KeyTraits {
  bool optional = false;          // the table can do without it
  std::string_view usually = {};  // default in words, if it is not a constant; implies `optional`
  bool completes = false;
  bool has_error = false;
  bool several = false;  // Key::or_array; get() reads one, Settings::numbers() several
  size_t size = 0;
  bool varies = false;  // Key::range_varies; get(key.within(…)) reads it
};

// Properties of keys of all types.
template <class Self>
struct TypedKey {
  std::string_view name, what;
  KeyTraits traits;

  constexpr operator std::string_view() const { return name; }

  // Copies of the key with another meaning, or optional.
  constexpr Self meaning(std::string_view sentence) const {
    return changed([=](Self& key) { key.what = sentence; });
  }
  constexpr Self optional() const {
    return changed([](Self& key) { key.traits.optional = true; });
  }
  constexpr Self usually(std::string_view words) const {
    return changed([=](Self& key) { key.traits.usually = words; });
  }

 protected:
  constexpr TypedKey(std::string_view key, std::string_view sentence, const KeyTraits& own)
      : name(key), what(sentence), traits(own) {}
  template <class Change>
  constexpr Self changed(Change change) const {
    Self copy = static_cast<const Self&>(*this);
    change(copy);
    return copy;
  }
  Key declared(Key::Type type) const {
    Key key;
    key.name = name;
    key.type = type;
    key.what = what;
    key.required = !traits.optional && !traits.completes && traits.usually.empty();
    key.usually = traits.usually;
    key.completes = traits.completes;
    key.has_error = traits.has_error;
    key.or_array = traits.several;
    key.size = traits.size;
    key.range_varies = traits.varies;
    return key;
  }
};

struct NumberKey : TypedKey<NumberKey> {
  std::optional<double> otherwise;
  Range range;

  constexpr NumberKey(std::string_view key, Range admitted, std::string_view sentence,
                      const KeyTraits& own = {})
      : TypedKey(key, sentence, own), range(admitted) {}
  constexpr NumberKey(std::string_view key, double usual, Range admitted, std::string_view sentence,
                      const KeyTraits& own = {})
      : TypedKey(key, sentence, own), otherwise(usual), range(admitted) {}
  constexpr NumberKey with_default(double usual) const {
    return changed([=](NumberKey& key) { key.otherwise = usual; });
  }
  constexpr NumberKey within(Range admitted) const {
    return changed([=](NumberKey& key) { key.range = admitted; });
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

  constexpr UncertainNumberKey(std::string_view key, Range admitted, std::string_view sentence,
                               const KeyTraits& own = {})
      : TypedKey(key, sentence, own), range(admitted) {}
  constexpr UncertainNumberKey(std::string_view key, Uncertain usual, Range admitted,
                               std::string_view sentence)
      : TypedKey(key, sentence, {}), otherwise(usual), range(admitted) {}

  Uncertain read(const Settings& settings) const {
    return otherwise && !settings.has(name) ? *otherwise : settings.uncertain(name, range);
  }
  operator Key() const;
};

struct IntegerKey : TypedKey<IntegerKey> {
  std::optional<int64_t> otherwise;
  int64_t low, high;

  constexpr IntegerKey(std::string_view key, int64_t least, int64_t most, std::string_view sentence,
                       const KeyTraits& own = {})
      : TypedKey(key, sentence, own), low(least), high(most) {}
  constexpr IntegerKey(std::string_view key, int64_t usual, int64_t least, int64_t most,
                       std::string_view sentence, const KeyTraits& own = {})
      : TypedKey(key, sentence, own), otherwise(usual), low(least), high(most) {}
  constexpr IntegerKey with_default(int64_t usual) const {
    return changed([=](IntegerKey& key) { key.otherwise = usual; });
  }
  constexpr IntegerKey within(int64_t least, int64_t most) const {
    return changed([=](IntegerKey& key) { key.low = least, key.high = most; });
  }

  int64_t read(const Settings& settings) const {
    return otherwise && !settings.has(name) ? *otherwise : settings.integer(name, low, high);
  }
  operator Key() const;
};

struct FlagKey : TypedKey<FlagKey> {
  bool otherwise;

  constexpr FlagKey(std::string_view key, bool usual, std::string_view sentence)
      : TypedKey(key, sentence, {}), otherwise(usual) {}
  bool read(const Settings& settings) const { return settings.flag_or(name, otherwise); }
  operator Key() const;
};

struct TextKey : TypedKey<TextKey> {
  std::optional<std::string_view> otherwise;

  constexpr TextKey(std::string_view key, std::string_view sentence, const KeyTraits& own = {})
      : TypedKey(key, sentence, own) {}
  constexpr TextKey(std::string_view key, std::string_view usual, std::string_view sentence)
      : TypedKey(key, sentence, {}), otherwise(usual) {}
  constexpr TextKey with_default(std::string_view usual) const {
    return changed([=](TextKey& key) { key.otherwise = usual; });
  }

  std::string read(const Settings& settings) const {
    return otherwise ? settings.text_or(name, *otherwise) : settings.text(name);
  }
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
      : TypedKey<ChoiceKey>(key, sentence, {}), words(std::to_array(all)) {}
  constexpr ChoiceKey(std::string_view key, const Word (&all)[count], size_t usual,
                      std::string_view sentence)
      : TypedKey<ChoiceKey>(key, sentence, {}), words(std::to_array(all)), otherwise(usual) {}
  constexpr ChoiceKey with_default(size_t usual) const {
    return this->changed([=](ChoiceKey& key) { key.otherwise = usual; });
  }

  size_t read(const Settings& settings) const {
    std::vector<std::string> names;
    for (const Word& word : words) names.emplace_back(word.name);
    return otherwise ? settings.choice_or(this->name, names, *otherwise)
                     : settings.choice(this->name, names);
  }
  // Declares the choice with the further keys of each word, in the order of the words.
  Key bringing(const std::vector<std::vector<Key>>& keys) const {
    Key key = this->declared(Key::Type::choice);
    for (size_t i = 0; i < count; ++i) {
      key.choices.push_back({std::string(words[i].name), std::string(words[i].what),
                             i < keys.size() ? keys[i] : std::vector<Key>{}});
    }
    if (!otherwise) return key;
    key.required = false;
    key.otherwise = SettingsNode{key.choices[*otherwise].name};
    return key;
  }
  operator Key() const { return bringing({}); }
};

// Three numbers.
struct Vec3Key : TypedKey<Vec3Key> {
  std::optional<std::array<double, 3>> otherwise;

  constexpr Vec3Key(std::string_view key, std::string_view sentence, const KeyTraits& own = {})
      : TypedKey(key, sentence, own) {}
  constexpr Vec3Key(std::string_view key, const std::array<double, 3>& usual,
                    std::string_view sentence)
      : TypedKey(key, sentence, {}), otherwise(usual) {}
  Vec3 read(const Settings& settings) const {
    return otherwise && !settings.has(name) ? Vec3(otherwise->data()) : settings.vector3(name);
  }
  operator Key() const;
};

// Three numbers that are not all zero, of any length; InputError for a zero vector.
Vec3 direction_of(const Settings& settings, const Vec3Key& key);

struct NumbersKey : TypedKey<NumbersKey> {
  Range range;

  constexpr NumbersKey(std::string_view key, Range admitted, std::string_view sentence,
                       const KeyTraits& own = {})
      : TypedKey(key, sentence, own), range(admitted) {}
  std::vector<double> read(const Settings& settings) const { return settings.numbers(name, range); }
  operator Key() const;
};

// A value of several forms (Key::Form), which its reader interprets.
struct OtherKey : TypedKey<OtherKey> {
  unsigned forms;

  constexpr OtherKey(std::string_view key, unsigned all, std::string_view sentence,
                     const KeyTraits& own = {})
      : TypedKey(key, sentence, own), forms(all) {}
  const SettingsNode& read(const Settings& settings) const { return settings.raw(name); }
  operator Key() const;
};

// Keys that have only a name and a sentence.
template <class Self>
struct PlainKey : TypedKey<Self> {
  constexpr PlainKey(std::string_view key, std::string_view sentence, const KeyTraits& own = {})
      : TypedKey<Self>(key, sentence, own) {}
};

struct TextsKey : PlainKey<TextsKey> {
  using PlainKey::PlainKey;
  std::vector<std::string> read(const Settings& settings) const { return settings.texts(name); }
  operator Key() const;
};

// An array of three numbers each.
struct Vec3sKey : PlainKey<Vec3sKey> {
  using PlainKey::PlainKey;
  std::vector<Vec3> read(const Settings& settings) const { return settings.vectors3(name); }
  operator Key() const;
};

// A table below this one, declared with its keys.
struct TableKey : PlainKey<TableKey> {
  using PlainKey::PlainKey;
  Settings read(const Settings& settings) const { return settings.table(name); }
  Key of(std::vector<Key> keys) const;
};

// An array of tables.
struct TablesKey : PlainKey<TablesKey> {
  using PlainKey::PlainKey;
  std::vector<Settings> read(const Settings& settings) const { return settings.tables(name); }
  Key of(std::vector<Key> keys) const;
};

}  // namespace photorque
