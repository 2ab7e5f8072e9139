// Declarations of the keys of an experiment: every key once, with type, unit, range, default and a
// sentence.
//
// Most keys are typed constants (core/settings/typed_keys.h) beside their readers. Tables, and
// choices whose words are not constants, are declared by the functions below. The schema, the
// tables in documents and `check` are made from these declarations.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

struct Key {
  enum class Type {
    number,
    numbers,  // an array of any length
    integer,
    flag,
    text,
    texts,
    choice,   // one text of `choices`
    vector,   // three numbers
    vectors,  // an array of such
    table,
    tables,  // an array of tables, or one table
    other,   // checked by its reader alone
  };
  // Bits for the forms of a TOML value, for readers that accept several.
  enum Form : unsigned {
    a_number = 1,
    an_array = 2,
    a_text = 4,
    a_table = 8,
    a_flag = 16,
    a_date = 32
  };

  // One word of a choice, and the keys that the table has only with this word.
  struct Choice {
    std::string name;
    std::string what = {};
    std::vector<Key> keys = {};
    std::string note = {};  // sentences that only documents print
  };

  std::string name;  // with the unit that documents print: "pitch_m"
  Type type = Type::number;
  std::string what;           // one sentence, as the meaning in a table of a document
  bool required = true;       // whatever other keys the table has
  bool completes = false;     // if present, required keys of the same table may be missing
  bool has_error = false;     // may be { value = …, sigma = … }
  bool or_array = false;      // a number that may be an array of them: one for each band, axis
  size_t size = 0;            // length of arrays of numbers; 0: any
  Range range = {};           // range of numbers, SI
  bool range_varies = false;  // the reader's range depends on other keys, and lies within `range`
  int64_t low = 0, high = 0;  // range of integers
  std::vector<Choice> choices = {};
  std::optional<SettingsNode> otherwise = {};  // the default, in the unit of `name`
  std::string usually = {};                    // the default in words, if it is not a constant
  unsigned forms = 0;                          // forms of Type::other
  std::vector<Key> keys = {};                  // keys of tables

  static Key choice(std::string name, std::vector<Choice> choices, std::string what);
  static Key choice_or(std::string name, std::vector<Choice> choices, size_t otherwise,
                       std::string what);
  static Key table(std::string name, std::vector<Key> keys, std::string what);
  static Key tables(std::string name, std::vector<Key> keys, std::string what);

  // Makes a key optional without a constant default.
  Key optional() &&;
  // The key with its default in words: "the file's".
  Key with_default_text(std::string words) &&;
  // A number, or an array of `count` of them.
  Key one_or_several(size_t count) &&;
  Key range_that_varies() &&;
};

// Concatenates lists of keys.
std::vector<Key> joined(std::initializer_list<std::vector<Key>> lists);
// Choices without further keys, one for each word.
std::vector<Key::Choice> words(std::initializer_list<const char*> names);

// Adds a choice. If there is one of the same name, their keys are merged: keys that one of the two
// lacks become optional.
void add_choice(std::vector<Key::Choice>& choices, Key::Choice added);

// The units of a quantity as suffixes of keys, in any order; for "per angle" the units of angles.
std::vector<KeyUnit> units_of(const std::string& dimension);

// The expectation of a reader, in the words of its messages: "a number > 0 W".
std::string expected_of(const Key& key);

// All keys that this table may contain: `keys`, and those of the words that it chooses.
std::vector<const Key*> keys_in(const SettingsNode::Table& table, const std::vector<Key>& keys);

// One error for each key of the tree that is not among `keys` or whose value has the wrong type,
// unit or range. Missing keys are left to the readers. `name` is the name of the table in messages.
std::vector<InputError> misread_keys(const SettingsNode& table, const std::vector<Key>& keys,
                                     const std::string& name = "");

}  // namespace photorque
