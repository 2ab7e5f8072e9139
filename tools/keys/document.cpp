#include "tools/keys/registry.h"

#include <algorithm>
#include <regex>
#include <span>
#include <sstream>
#include <utility>

#include "core/errors.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// Escapes a text for a table cell.
std::string in_cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) {
    if (at > 0 && text[at - 1] == '\\') continue;
    text.insert(at, "\\");
  }
  return text;
}

// A row of the table with the rows below it: keys of a table, or of a choice that adds keys.
struct Row {
  std::string name, otherwise, range, what;
  bool indents = true;   // its rows are indented by one step
  bool is_kind = false;  // a choice that adds keys
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
    Group above{"above", {}, {}};
    print_all(rows, 0, "", &above);
    return "| key | default | range | meaning |\n|---|---|---|---|\n" + printed_;
  }

 private:
  // Rows of a printed table or choice, with their depth below it.
  struct Group {
    std::string label;
    std::vector<std::pair<int, std::string>> lines;
    // Rows that have no rows below them and were printed with their meaning.
    std::vector<Row> full = {};
  };

  static std::string cells(const Row& row) {
    return row.name + " | " + in_cell(row.otherwise) + " | " + in_cell(row.range) + " | " +
           in_cell(row.what) + " |\n";
  }

  static bool differ_in_name_only(const Row& a, const Row& b) {
    return a.rows.empty() && b.rows.empty() && a.otherwise == b.otherwise && a.range == b.range &&
           a.what == b.what;
  }

  static std::string names_of(std::span<const Row> rows) {
    return joined_text(rows, ", ", [](const Row& row) { return row.name; });
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
    if (brings) row.rows = is_top ? kinds_of(key, is_top) : with_shared_rows(kinds_of(key, is_top));
    row.indents = false;
    return row;
  }

  // The choices of a key, each with the keys that it adds.
  std::vector<Row> kinds_of(const Key& key, bool is_top) const {
    std::vector<Row> rows;
    for (const Key::Choice& choice : key.choices) {
      if (!kinds_.empty() && is_top && std::ranges::find(kinds_, choice.name) == kinds_.end()) {
        continue;
      }
      Row row{is_top ? "**`" + choice.name + "`**"
                     : "with `" + key.name + " = \"" + choice.name + "\"`",
              "", "", choice.what + (choice.note.empty() ? "" : ". " + choice.note)};
      row.is_kind = is_top;
      for (const Key& inner : choice.keys) row.rows.push_back(row_of(inner, path_, false));
      rows.push_back(std::move(row));
    }
    return rows;
  }

  // Choices with several common keys: each choice lists the names of its keys, and the rows of all
  // keys follow once.
  static std::vector<Row> with_shared_rows(const std::vector<Row>& choices) {
    std::vector<Row> named, keys;
    size_t all = 0;
    for (const Row& choice : choices) {
      named.push_back({choice.name, "", "", choice.what});
      if (!choice.rows.empty()) named.back().what += "; " + names_of(choice.rows);
      all += choice.rows.size();
      for (const Row& row : choice.rows) {
        if (!row.rows.empty()) return choices;
        const auto known = std::ranges::find_if(keys, [&](const Row& other) {
          return other.name == row.name && other.otherwise == row.otherwise &&
                 other.range == row.range;
        });
        if (known == keys.end()) {
          keys.push_back(row);
        } else if (known->what.find(row.what) == std::string::npos) {
          known->what += "; " + row.what;
        }
      }
    }
    constexpr size_t fewest_saved = 6;
    if (all < keys.size() + fewest_saved) return choices;
    named.insert(named.end(), keys.begin(), keys.end());
    return named;
  }

  // Prints rows of one level. Rows that occur in an earlier kind or table are only listed by name
  // in one row, as are neighbours with equal default, range and meaning. `above`: the rows of the
  // top level.
  void print_all(std::span<const Row> rows, int depth, const std::string& owner, Group* above,
                 Group* group = nullptr) {
    for (size_t i = 0; i < rows.size();) {
      const auto [known, repeated] = repetition(rows.subspan(i));
      size_t count = 1;
      if (repeated > 1) {
        count = repeated;
        const std::span<const Row> run = rows.subspan(i, count);
        const bool is_default_new = find(*known, run[0])->otherwise != run[0].otherwise;
        print_line(
            {names_of(run), is_default_new ? run[0].otherwise : "", "", "as in " + known->label},
            depth);
      } else {
        while (i + count < rows.size() && differ_in_name_only(rows[i], rows[i + count])) ++count;
        Row row = rows[i];
        row.name = names_of(rows.subspan(i, count));
        print(row, depth, owner, above);
        if (group != nullptr && row.rows.empty()) {
          const std::span<const Row> all = rows.subspan(i, count);
          group->full.insert(group->full.end(), all.begin(), all.end());
        }
      }
      for (size_t k = i; above != nullptr && k < i + count; ++k) append(rows[k], 0, above->lines);
      i += count;
    }
  }

  static const Row* find(const Group& group, const Row& row) {
    const auto found = std::ranges::find_if(group.full, [&](const Row& other) {
      return other.name == row.name && other.range == row.range && other.what == row.what;
    });
    return found == group.full.end() ? nullptr : &*found;
  }

  // The printed group that contains the longest sequence of the first `rows`, and its length: with
  // equal defaults, or all with one other default.
  std::pair<const Group*, size_t> repetition(std::span<const Row> rows) const {
    std::pair<const Group*, size_t> longest{nullptr, 0};
    for (const Group& group : groups_) {
      const auto count = [&](bool has_own_default) {
        size_t same = 0;
        for (; same < rows.size() && rows[same].rows.empty(); ++same) {
          const Row* other = find(group, rows[same]);
          const std::string& expected =
              has_own_default || other == nullptr ? rows[0].otherwise : other->otherwise;
          if (other == nullptr || rows[same].otherwise != expected) break;
        }
        return same;
      };
      const size_t same = std::max(count(false), count(true));
      if (same > longest.second) longest = {&group, same};
    }
    return longest;
  }

  void print_line(const Row& row, int depth) {
    printed_ += "| ";
    for (int i = 0; i < depth; ++i) printed_ += "… ";
    printed_ += cells(row);
  }

  // `owner`: the kind to which the row belongs, empty outside kinds. `above`: the printed rows of
  // the top level.
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
    print_line(shown, depth);
    const std::string name = row.is_kind ? row.name.substr(2, row.name.size() - 4) : row.name;
    const std::string kind = row.is_kind ? name : owner;
    if (shown.rows.empty()) return;
    Group group{kind.empty() ? name : kind, std::move(lines)};
    print_all(shown.rows, depth + (row.indents ? 1 : 0), kind, nullptr, &group);
    groups_.push_back(std::move(group));
  }

  // The printed group that contains all of `lines` in their order.
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

// Replaces the text between "<!-- NAME begin -->" and "<!-- NAME end -->" of a document.
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
