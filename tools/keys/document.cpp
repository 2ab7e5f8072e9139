#include "tools/keys/registry.h"

#include <algorithm>
#include <regex>
#include <sstream>
#include <utility>

#include "core/errors.h"

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

// A row of the table, and the rows of the keys in it: of a table, or of a choice that brings keys.
struct Row {
  std::string name, otherwise, range, what;
  bool indents = true;   // its rows stand one step to the right
  bool is_kind = false;  // a choice that brings keys
  std::vector<Row> rows = {};
};

class KeyTable {
 public:
  KeyTable(std::string path, std::vector<std::string> kinds)
      : path_(std::move(path)), kinds_(std::move(kinds)) {}

  std::string text(const Key& table) {
    std::vector<Row> rows;
    if (kinds_.empty()) {
      for (const Key& key : table.keys) rows.push_back(row_of(key, path_, true));
    } else {
      rows = kinds_of(table.keys.front(), true);
    }
    Group above{"above", {}};
    for (const Row& row : rows) {
      print(row, 0, "", &above);
      append(row, 0, above.lines);
    }
    return "| key | default | range | meaning |\n|---|---|---|---|\n" + printed_;
  }

 private:
  // The rows of one table or choice that has been printed, with their depth below it.
  struct Group {
    std::string label;
    std::vector<std::pair<int, std::string>> lines;
  };

  static std::string cells(const Row& row) {
    return row.name + " | " + in_cell(row.otherwise) + " | " + in_cell(row.range) + " | " +
           in_cell(row.what) + " |\n";
  }

  static void append(const Row& row, int depth, std::vector<std::pair<int, std::string>>& lines) {
    lines.emplace_back(depth, cells(row));
    for (const Row& inner : row.rows) append(inner, depth + (row.indents ? 1 : 0), lines);
  }

  Row row_of(const Key& key, const std::string& path, bool is_top) const {
    const std::string full = path + "." + key.name;
    if (key.type == Key::Type::table || key.type == Key::Type::tables) {
      const bool is_array = key.type == Key::Type::tables;
      Row row{is_array ? "`[[" + full + "]]`" : "`[" + full + "]`", key.usually, "", key.what};
      for (const Key& inner : key.keys) row.rows.push_back(row_of(inner, full, false));
      return row;
    }
    const bool brings = std::ranges::any_of(
        key.choices, [](const Key::Choice& choice) { return !choice.keys.empty(); });
    Row row{"`" + key.name + "`" + (key.has_error ? " ±" : ""), default_in_words(key),
            range_in_words(key), key.what};
    const std::string words = brings ? "" : choices_in_words(key);
    if (!words.empty()) row.what += ": " + words;
    if (brings) row.rows = kinds_of(key, is_top);
    row.indents = false;
    return row;
  }

  // The choices of a key, each with the keys that it brings.
  std::vector<Row> kinds_of(const Key& key, bool is_top) const {
    std::vector<Row> rows;
    for (const Key::Choice& choice : key.choices) {
      if (!kinds_.empty() && is_top && std::ranges::find(kinds_, choice.name) == kinds_.end()) {
        continue;
      }
      Row row{is_top ? "**`" + choice.name + "`**"
                     : "with `" + key.name + " = \"" + choice.name + "\"`",
              "", "", choice.what};
      row.is_kind = is_top;
      for (const Key& inner : choice.keys) row.rows.push_back(row_of(inner, path_, false));
      rows.push_back(std::move(row));
    }
    return rows;
  }

  // `owner`: the kind that the row belongs to, empty outside of kinds. `above`: the rows of the
  // top level that have been printed.
  void print(const Row& row, int depth, const std::string& owner, const Group* above) {
    std::vector<std::pair<int, std::string>> lines;
    for (const Row& inner : row.rows) append(inner, row.indents ? 1 : 0, lines);
    Row shown = row;
    if (const Group* same = lines.size() < 2 ? nullptr : group_with(lines, above)) {
      shown.what += "; keys as " + (same == above ? "above" : "in " + same->label);
      for (size_t i = 0; row.indents && i < row.rows.size(); ++i) {
        shown.what += (i == 0 ? ": " : ", ") + row.rows[i].name;
      }
      shown.rows.clear();
    }
    printed_ += "| ";
    for (int i = 0; i < depth; ++i) printed_ += "… ";
    printed_ += cells(shown);
    const std::string name = row.is_kind ? row.name.substr(2, row.name.size() - 4) : row.name;
    const std::string kind = row.is_kind ? name : owner;
    for (const Row& inner : shown.rows) {
      print(inner, depth + (row.indents ? 1 : 0), kind, nullptr);
    }
    if (!shown.rows.empty()) groups_.push_back({kind.empty() ? name : kind, std::move(lines)});
  }

  // The printed group that has all of `lines` in their order.
  const Group* group_with(const std::vector<std::pair<int, std::string>>& lines,
                          const Group* above) const {
    const auto holds = [&](const Group& group, int deeper) {
      size_t found = 0;
      for (const auto& [depth, line] : group.lines) {
        if (found < lines.size() && lines[found].first == depth + deeper &&
            lines[found].second == line) {
          ++found;
        }
      }
      return found == lines.size();
    };
    for (const Group& group : groups_) {
      if (holds(group, 0)) return &group;
    }
    return above && holds(*above, 1) ? above : nullptr;
  }

  std::string path_;
  std::vector<std::string> kinds_;
  std::vector<Group> groups_;
  std::string printed_;
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
