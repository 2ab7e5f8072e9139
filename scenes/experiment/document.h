// Writer of all TOML documents.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// One value on one line, with inline tables. Real numbers are read back as the same doubles.
// Control characters in texts are escaped; bytes that are not UTF-8, which TOML does not allow,
// become U+FFFD.
std::string toml_value(const SettingsNode& node);

// Whether two trees contain the same values of the same types, at any lines.
bool same_values(const SettingsNode& a, const SettingsNode& b);

// A TOML document: its values and their comments.
//
// Values keep the order of the lines from which they were read; added values come last. A comment
// stays with the value above or beside which it stands. Blank lines and the notation of values
// (several lines, dotted keys, number format) are not kept.
class TomlDocument {
 public:
  TomlDocument() = default;
  // A document without comments.
  explicit TomlDocument(SettingsNode::Table root);
  // Throws InputError like parse_toml(). The line "#:schema ..." is removed, because it is valid in
  // one folder only.
  TomlDocument(const std::string& text, const std::string& name);

  SettingsNode root;

  // Adds a comment at the start of the document, after earlier ones; wrapped at 100 bytes.
  void add_to_head(const std::string& text);
  // Adds a comment above the next value that is added or replaced, or at the end; wrapped at 100
  // bytes.
  void comment(const std::string& text);
  // The table of this name at the root; created if missing. Throws InputError if the name belongs
  // to another type of value.
  SettingsNode::Table& table(const std::string& name);
  // Appends a new table to an array of tables at the root. A single table of that name becomes the
  // first element of the array. Throws InputError if the name belongs to a value. The reference is
  // valid until the next call.
  SettingsNode::Table& append(const std::string& name);
  // Sets a value in a table of this document; "a.b" is b in the table a. `beside` is a comment
  // after the value.
  void set(SettingsNode::Table& table, std::string_view key, SettingsNode value,
           const std::string& beside = "");
  // Replaces name and value at `key` of `table`; position and comments stay.
  void replace(SettingsNode::Table& table, const std::string& key, const std::string& new_key,
               SettingsNode value);

  // Text of the document. Checks that it is read back as the same values; throws NumericalError
  // otherwise.
  std::string text() const;

 private:
  struct Comment {
    int line = 0;         // of the value beside it, or of the comment itself
    std::string text;     // from # on
    bool beside = false;  // after a value, or within it
  };

  int next_line();

  std::vector<std::string> head_, pending_;
  std::vector<Comment> comments_;
  int last_line_ = 0;
};

// Text of a document without comments.
std::string toml_document(const SettingsNode::Table& root);

}  // namespace photorque
