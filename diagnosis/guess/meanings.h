// Meanings of the names of columns, by words in English, German, French, Spanish, Italian and
// Portuguese.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "diagnosis/guess/header.h"

namespace photorque {

inline bool begins(const std::string& word, std::initializer_list<const char*> with) {
  return std::ranges::any_of(with, [&](const char* w) { return word.starts_with(w); });
}

inline bool is_one_of(const std::string& word, std::initializer_list<const char*> of) {
  return std::ranges::find(of, word) != of.end();
}

// The words of a column name, with tests on them.
struct Words {
  std::vector<std::string> all;

  bool has_word_with_prefix(std::initializer_list<const char*> with) const {
    return std::ranges::any_of(all, [&](const std::string& word) { return begins(word, with); });
  }
  bool any_is(std::initializer_list<const char*> of) const {
    return std::ranges::any_of(all, [&](const std::string& word) { return is_one_of(word, of); });
  }
  // Part of a word: "winkel" of "Auslenkwinkel".
  bool any_has(std::initializer_list<const char*> parts) const {
    return std::ranges::any_of(all, [&](const std::string& word) {
      return std::ranges::any_of(
          parts, [&](const char* part) { return word.find(part) != std::string::npos; });
    });
  }
};

// x, y or z: a separate word, the last letter of another word, or one of three numbers. Empty if
// the name has no axis. `siblings`: the words of all columns.
std::string axis_of(const Words& words, const std::vector<Words>& siblings);

// A channel name without its unit, the unit to assume if none is stated, and a further assumption
// for the user to confirm (empty: none).
struct Meaning {
  std::string stem, usual_unit;
  std::string because = {};
};

// Whether the name denotes something other than a reading of motion: an error, a target, an
// increment.
bool is_of_another_kind(const Words& words);

// Possible meanings, the first the most likely. Words of a derivative are stronger than those of
// what is derived: "Winkelgeschwindigkeit", "velocidad angular".
std::vector<Meaning> meanings(const Words& words, const std::string& axis, const HeaderCell& cell);

// "q_w" … "q_z" for q0 … q3, qw … qz, "quaternion w"; empty for another name.
std::string quaternion_of(const std::vector<std::string>& words);

}  // namespace photorque
