// TOML documents that the program writes: the one writer of all of them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// One value on one line, tables inline. Real numbers read back as the same doubles. Control
// characters of texts are escaped; bytes that are not UTF-8, which TOML cannot hold, become U+FFFD.
std::string toml_value(const SettingsNode& node);

// Whether two trees hold the same values of the same types, wherever they were written.
bool same_values(const SettingsNode& a, const SettingsNode& b);

// A TOML document: its values, and the comments beside them.
//
// Values keep the order of the lines that they were read from; what is added comes last. Comments
// of the text stay with the value that they stand above or beside. Not kept are blank lines, and
// how a value was written: over several lines, under a dotted key, in which notation.
class TomlDocument {
 public:
  TomlDocument() = default;
  // A document without comments.
  explicit TomlDocument(SettingsNode::Table root);
  // InputError as of parse_toml(). The line "#:schema ..." is left out: it holds for one folder.
  TomlDocument(const std::string& text, const std::string& name);

  SettingsNode root;

  // A comment before everything else, in order; long ones are broken into lines of 100 bytes.
  void add_to_head(const std::string& text);
  // A comment above what is added or replaced next, or at the end; broken into lines of 100 bytes.
  void comment(const std::string& text);
  // The table of this name at the root; made if there is none. InputError if it is no table.
  SettingsNode::Table& table(const std::string& name);
  // A new table, last in an array of tables at the root. A single table of that name becomes the
  // first of the array. InputError if the name is that of a value. The reference holds until the
  // next call.
  SettingsNode::Table& append(const std::string& name);
  // Sets a value of a table of this document; "a.b" is b in the table a. `beside` is a comment
  // behind it.
  void set(SettingsNode::Table& table, std::string_view key, SettingsNode value,
           const std::string& beside = "");
  // Gives the value at `key` of `table` a new name and value; place and comments stay.
  void replace(SettingsNode::Table& table, const std::string& key, const std::string& new_key,
               SettingsNode value);

  // The document as text that reads back as the same values, which is checked. NumericalError if it
  // does not.
  std::string text() const;

 private:
  struct Comment {
    int line = 0;         // of the value that it belongs to, or that it stands before
    std::string text;     // from # on
    bool beside = false;  // stands behind a value, or within it
  };

  int next_line();

  std::vector<std::string> head_, pending_;
  std::vector<Comment> comments_;
  int last_line_ = 0;
};

// The text of a document without comments.
std::string toml_document(const SettingsNode::Table& root);

}  // namespace photorque
