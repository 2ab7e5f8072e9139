#include "tools/keys/document.h"

#include <algorithm>
#include <regex>
#include <sstream>

#include "core/errors.h"
#include "tools/keys/words.h"

namespace photorque {
namespace {

// Within a cell of a table.
std::string in_cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) {
    if (at > 0 && text[at - 1] == '\\') continue;
    text.insert(at, "\\");
  }
  return text;
}

class KeyTable {
 public:
  KeyTable(std::string path, std::vector<std::string> kinds)
      : path_(std::move(path)), kinds_(std::move(kinds)) {}

  std::string text(const Key& table) {
    if (kinds_.empty()) {
      for (const Key& key : table.keys) add(key, path_, "");
    } else {
      add_kinds(table.keys.front(), "");
    }
    return "| key | default | range | meaning |\n|---|---|---|---|\n" + rows_;
  }

 private:
  void row(const std::string& name, const std::string& otherwise, const std::string& range,
           const std::string& what) {
    rows_ += "| " + name + " | " + in_cell(otherwise) + " | " + in_cell(range) + " | " +
             in_cell(what) + " |\n";
  }

  void add(const Key& key, const std::string& path, const std::string& mark) {
    const std::string full = path + "." + key.name;
    if (key.type == Key::Type::table || key.type == Key::Type::tables) {
      const bool many = key.type == Key::Type::tables;
      row(mark + (many ? "`[[" + full + "]]`" : "`[" + full + "]`"), key.usually, "", key.what);
      for (const Key& inner : key.keys) add(inner, full, mark + "… ");
      return;
    }
    const bool brings = std::ranges::any_of(
        key.choices, [](const Key::Choice& choice) { return !choice.keys.empty(); });
    std::string what = key.what;
    const std::string words = brings ? "" : choices_in_words(key);
    if (!words.empty()) what += ": " + words;
    row(mark + "`" + key.name + "`" + (key.has_error ? " ±" : ""), default_in_words(key),
        range_in_words(key), what);
    if (brings) add_kinds(key, mark);
  }

  // A word of a choice, and the keys that it brings.
  void add_kinds(const Key& key, const std::string& mark) {
    for (const Key::Choice& choice : key.choices) {
      if (!kinds_.empty() && mark.empty() &&
          std::ranges::find(kinds_, choice.name) == kinds_.end()) {
        continue;
      }
      row(mark + (mark.empty() ? "**`" + choice.name + "`**"
                               : "with `" + key.name + " = \"" + choice.name + "\"`"),
          "", "", choice.what);
      for (const Key& inner : choice.keys) add(inner, path_, mark + "… ");
    }
  }

  std::string path_;
  std::vector<std::string> kinds_;
  std::string rows_;
};

const Key& table_at(const std::vector<Key>& tables, const std::string& path,
                    const std::string& file) {
  const size_t dot = path.find('.');
  const std::string name = path.substr(0, dot);
  for (const Key& key : tables) {
    if (key.name != name) continue;
    return dot == std::string::npos ? key : table_at(key.keys, path.substr(dot + 1), file);
  }
  throw InputError({file}, "keys " + path, "no such table", "a table of an experiment");
}

// `document` with the text between "<!-- NAME begin -->" and "<!-- NAME end -->" replaced.
std::string with_section(const std::string& document, const std::string& name,
                         const std::string& text, const std::string& file) {
  const std::string begin = "<!-- " + name + " begin -->\n", end = "<!-- " + name + " end -->";
  const size_t from = document.find(begin), to = document.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) {
    throw InputError({file, 0}, "", "no lines \"<!-- " + name + " begin -->\" and end",
                     "a document with both");
  }
  return document.substr(0, from + begin.size()) + "\n" + text + "\n" + document.substr(to);
}

}  // namespace

std::string with_key_tables(const std::string& document, const std::vector<Key>& tables,
                            const std::string& file) {
  static const std::regex mark(R"(<!-- (keys ([^\n]*)) begin -->)");
  std::string text = document;
  for (std::sregex_iterator it(document.begin(), document.end(), mark), end; it != end; ++it) {
    std::istringstream words((*it)[2].str());
    std::string path;
    words >> path;
    std::vector<std::string> kinds;
    for (std::string kind; words >> kind;) kinds.push_back(kind);
    const Key& table = table_at(tables, path, file);
    text = with_section(text, (*it)[1], KeyTable(path, kinds).text(table), file);
  }
  return text;
}

}  // namespace photorque
