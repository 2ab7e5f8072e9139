// The contents of a table of an experiment: every key once, with type, unit, range, default and a
// sentence.
//
// A reader's keys are typed constants (core/settings/typed_keys.h), which each room lists beside
// their readers; tables, and choices whose words are no constants, are declared by the functions
// below. Schema, tables in documents and `check` are made from these declarations.
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
  // Forms of a TOML value where the reader accepts several; bits.
  enum Form : unsigned {
    a_number = 1,
    an_array = 2,
    a_text = 4,
    a_table = 8,
    a_flag = 16,
    a_date = 32
  };

  // One word of a choice, and the keys that the table has with it and not without.
  struct Choice {
    std::string name;
    std::string what = {};
    std::vector<Key> keys = {};
    std::string note = {};  // sentences that only documents print
  };

  std::string name;  // with the unit that documents show: "pitch_m"
  Type type = Type::number;
  std::string what;           // one sentence, as the meaning in a table of a document
  bool required = true;       // with any other keys of the table
  bool completes = false;     // where it stands, required keys beside it may be missing
  bool has_error = false;     // may be { value = …, sigma = … }
  bool or_array = false;      // a number that may be an array of them: one for each band, axis
  size_t size = 0;            // of arrays of numbers; 0: any
  Range range = {};           // of numbers, SI
  bool range_varies = false;  // the reader's depends on other keys, and lies within `range`
  int64_t low = 0, high = 0;  // of integers
  std::vector<Choice> choices = {};
  std::optional<SettingsNode> otherwise = {};  // the default, in the unit of `name`
  std::string usually = {};                    // the default in words, where it is no constant
  unsigned forms = 0;                          // of Type::other
  std::vector<Key> keys = {};                  // of tables

  static Key choice(std::string name, std::vector<Choice> choices, std::string what);
  static Key choice_or(std::string name, std::vector<Choice> choices, size_t otherwise,
                       std::string what);
  static Key table(std::string name, std::vector<Key> keys, std::string what);
  static Key tables(std::string name, std::vector<Key> keys, std::string what);

  // For keys that a table can do without and that have no constant for a default.
  Key optional() &&;
  // The key with its default in words: "the file's".
  Key with_default_text(std::string words) &&;
  // A number, or an array of `count` of them.
  Key one_or_several(size_t count) &&;
  Key range_that_varies() &&;
};

// Several lists of keys one after the other.
std::vector<Key> joined(std::initializer_list<std::vector<Key>> lists);
// Choices of words that bring no further keys.
std::vector<Key::Choice> words(std::initializer_list<const char*> names);

// Adds a choice; one of the same name gains its keys, of which those that either lacks are
// optional.
void add_choice(std::vector<Key::Choice>& choices, Key::Choice added);

// The units of a quantity, as suffixes of keys, in no order; of "per angle" those of angles.
std::vector<KeyUnit> units_of(const std::string& dimension);

// The expectation of a reader, in the words of its messages: "a number > 0 W".
std::string expected_of(const Key& key);

// The keys that a table holds which looks like this: `keys`, and those that its choices bring.
std::vector<const Key*> keys_in(const SettingsNode::Table& table, const std::vector<Key>& keys);

// Every key of the tree that is not among `keys`, or whose value has the wrong type, unit or range:
// one error each. Missing keys are left to the readers. `name` is how messages call the table.
std::vector<InputError> misread_keys(const SettingsNode& table, const std::vector<Key>& keys,
                                     const std::string& name = "");

}  // namespace photorque
