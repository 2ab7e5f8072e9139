#include "scenes/experiment/document.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text/format.h"
#include "core/text/parse.h"
#include "scenes/experiment/toml.h"

namespace photorque {
namespace {

constexpr size_t comment_bytes = 100;  // maximum length of one line
// Deeper tables are written inline: parse_toml() accepts keys of at most 16 parts.
constexpr size_t deepest_section = 4;

// Copies the text character by character with `escape` applied. Bytes that are not UTF-8 become
// U+FFFD.
template <class Escape>
std::string for_each_character(std::string_view text, const Escape& escape) {
  std::string all;
  while (!text.empty()) {
    const std::string_view character = text.substr(0, first_character_bytes(text));
    all += escape(character, clean_text(character));
    text.remove_prefix(character.size());
  }
  return all;
}

std::string valid_text(std::string_view text) {
  return for_each_character(text, [](std::string_view character, const std::string& clean) {
    return clean == " " ? std::string(character) : clean;
  });
}

std::string quoted_text(std::string_view text) {
  const auto escaped = [](std::string_view character, const std::string& clean) {
    if (character == "\"" || character == "\\") return "\\" + clean;
    if (clean != " " || character == " ") return clean;
    if (character == "\n") return std::string("\\n");
    if (character == "\t") return std::string("\\t");
    // For control characters from U+0080 on, the second UTF-8 byte is the code.
    return printed("\\u%04x", static_cast<unsigned char>(character.back()));
  };
  return '"' + for_each_character(text, escaped) + '"';
}

std::string key_text(std::string_view key) {
  const bool is_bare = !key.empty() && std::ranges::all_of(key, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
  return is_bare ? std::string(key) : quoted_text(key);
}

std::string real_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  const std::string text = shortest(value);
  return text.find_first_of(".eE") == std::string::npos ? text + ".0" : text;
}

// Range of lines from which a value was read; empty for values that were not read from a text.
struct LineRange {
  int first = std::numeric_limits<int>::max();
  int last = 0;
  void add(const SettingsNode& node) {
    for_each_node(node, [this](const SettingsNode& one) {
      if (one.where.line <= 0) return;
      first = std::min(first, one.where.line);
      last = std::max(last, one.where.line);
    });
  }
};

// A table that was read from one line is written on one line, otherwise as a section.
bool is_inline(const SettingsNode& node) {
  LineRange lines;
  lines.add(node);
  return lines.first >= lines.last;
}

// Entries of a table in the order of their lines; entries without a line come last, by name. On one
// line `value` comes first: { value = 1, sigma = 0.1 }.
std::vector<const SettingsNode::Table::value_type*> in_order(const SettingsNode::Table& table) {
  std::vector<const SettingsNode::Table::value_type*> entries;
  for (const auto& entry : table) entries.push_back(&entry);
  const auto place = [](const SettingsNode::Table::value_type* entry) {
    LineRange lines;
    lines.add(entry->second);
    return std::pair(lines.first, entry->first != "value");
  };
  std::ranges::stable_sort(entries, {}, place);
  return entries;
}

struct ValueWriter {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return real_text(value); }
  std::string operator()(const std::string& value) const { return quoted_text(value); }
  std::string operator()(const SettingsNode::Array& items) const {
    return "[" + joined_text(items, ", ", toml_value) + "]";
  }
  std::string operator()(const SettingsNode::Table& table) const {
    const std::string all = joined_text(in_order(table), ", ", [&](const auto* entry) {
      return key_text(entry->first) + " = " + toml_value(entry->second);
    });
    return all.empty() ? "{}" : "{ " + all + " }";
  }
};

const SettingsNode::Array* tables_of(const SettingsNode& node) {
  const auto* items = std::get_if<SettingsNode::Array>(&node.value);
  const bool all_tables = items != nullptr && !items->empty() &&
                          std::ranges::all_of(*items, [](const auto& i) { return i.is_table(); });
  return all_tables ? items : nullptr;
}

// A line of the document, and the line from which its value was read (0: none).
struct Line {
  int from = 0;
  std::string text;
  bool begins_section = false;
};

class Writer {
 public:
  std::vector<Line> lines;

  // Writes the values of a table, then its sections. `path` is the table's name in headers; empty
  // for the root.
  void write(const SettingsNode::Table& table, const std::string& path, size_t depth) {
    std::vector<const SettingsNode::Table::value_type*> sections;
    for (const auto* entry : in_order(table)) {
      const auto& [key, node] = *entry;
      if (is_section(node, depth)) {
        sections.push_back(entry);
      } else {
        lines.push_back({node.where.line, key_text(key) + " = " + toml_value(node)});
      }
    }
    for (const auto* entry : sections) {
      const std::string name = (path.empty() ? "" : path + ".") + key_text(entry->first);
      if (const auto* items = tables_of(entry->second)) {
        for (const SettingsNode& item : *items) {
          lines.push_back({item.where.line, "[[" + name + "]]", true});
          write(std::get<SettingsNode::Table>(item.value), name, depth + 1);
        }
      } else {
        write_section(entry->second, name, depth + 1);
      }
    }
  }

 private:
  static bool is_section(const SettingsNode& node, size_t depth) {
    if (!node.is_table() && tables_of(node) == nullptr) return false;
    if (depth == 0) return true;
    if (depth >= deepest_section) return false;
    const auto* items = tables_of(node);
    return items == nullptr ? !is_inline(node) : !std::ranges::all_of(*items, is_inline);
  }

  // A table that contains only sections gets no header.
  void write_section(const SettingsNode& node, const std::string& name, size_t depth) {
    const auto& table = std::get<SettingsNode::Table>(node.value);
    const bool has_values = table.empty() || std::ranges::any_of(table, [&](const auto& entry) {
                              return !is_section(entry.second, depth);
                            });
    if (has_values) lines.push_back({node.where.line, "[" + name + "]", true});
    write(table, name, depth);
  }
};

std::vector<std::string> comment_lines(const std::string& text) {
  std::vector<std::string> lines{"#"};
  const std::string clean = clean_text(text);
  for (const std::string_view word : words_of(clean)) {
    if (lines.back().size() > 1 && lines.back().size() + 1 + word.size() > comment_bytes) {
      lines.emplace_back("#");
    }
    lines.back() += " " + std::string(word);
  }
  return lines;
}

}  // namespace

std::string toml_value(const SettingsNode& node) {
  return std::visit(ValueWriter{}, node.value);
}

bool same_values(const SettingsNode& a, const SettingsNode& b) {
  if (a.value.index() != b.value.index()) return false;
  if (const auto* table = std::get_if<SettingsNode::Table>(&a.value)) {
    return std::ranges::equal(*table, std::get<SettingsNode::Table>(b.value),
                              [](const auto& x, const auto& y) {
                                return x.first == y.first && same_values(x.second, y.second);
                              });
  }
  if (const auto* items = std::get_if<SettingsNode::Array>(&a.value)) {
    return std::ranges::equal(*items, std::get<SettingsNode::Array>(b.value), same_values);
  }
  if (const auto* real = std::get_if<double>(&a.value)) {
    const double other = std::get<double>(b.value);
    return std::isnan(*real) ? std::isnan(other)
                             : *real == other && std::signbit(*real) == std::signbit(other);
  }
  if (const auto* text = std::get_if<std::string>(&a.value)) {
    return valid_text(*text) == valid_text(std::get<std::string>(b.value));
  }
  if (const auto* flag = std::get_if<bool>(&a.value)) return *flag == std::get<bool>(b.value);
  return std::get<int64_t>(a.value) == std::get<int64_t>(b.value);
}

TomlDocument::TomlDocument(SettingsNode::Table root_table) {
  root.value = std::move(root_table);
}

TomlDocument::TomlDocument(const std::string& text, const std::string& name)
    : root(parse_toml(text, name)) {
  for (const TomlComment& found : toml_comments(text)) {
    if (found.text.starts_with("#:schema")) continue;
    comments_.push_back({found.line, found.text, found.beside});
  }
  last_line_ = static_cast<int>(std::ranges::count(text, '\n')) + 1;
}

int TomlDocument::next_line() {
  for (std::string& line : pending_) comments_.push_back({last_line_, std::move(line)});
  pending_.clear();
  return ++last_line_;
}

void TomlDocument::add_to_head(const std::string& text) {
  const std::string line = "# " + clean_text(text);
  if (line.size() <= comment_bytes) {
    head_.push_back(line);
  } else {
    std::ranges::move(comment_lines(text), std::back_inserter(head_));
  }
}

void TomlDocument::comment(const std::string& text) {
  std::ranges::move(comment_lines(text), std::back_inserter(pending_));
}

SettingsNode::Table& TomlDocument::table(const std::string& name) {
  auto& all = std::get<SettingsNode::Table>(root.value);
  const auto [at, is_new] = all.try_emplace(name);
  if (is_new) at->second.where.line = next_line();
  if (!at->second.is_table()) throw InputError(at->second.where, name, "a value", "a table");
  return std::get<SettingsNode::Table>(at->second.value);
}

SettingsNode::Table& TomlDocument::append(const std::string& name) {
  auto& all = std::get<SettingsNode::Table>(root.value);
  const auto [at, is_new] = all.try_emplace(name);
  SettingsNode& node = at->second;
  if (is_new) {
    node.value = SettingsNode::Array{};
  } else if (node.is_table()) {
    SettingsNode single = std::move(node);
    node.where = single.where;
    node.value = SettingsNode::Array{std::move(single)};
  }
  auto* items = std::get_if<SettingsNode::Array>(&node.value);
  if (items == nullptr) throw InputError(node.where, name, describe(node), "an array of tables");
  SettingsNode item;
  item.where.line = next_line();
  if (is_new) node.where = item.where;
  items->push_back(std::move(item));
  return std::get<SettingsNode::Table>(items->back().value);
}

void TomlDocument::set(SettingsNode::Table& table, std::string_view key, SettingsNode value,
                       const std::string& beside) {
  const size_t dot = key.find('.');
  if (dot != std::string_view::npos) {
    const auto [at, is_new] = table.try_emplace(std::string(key.substr(0, dot)));
    SettingsNode& inner = at->second;
    if (is_new) inner.where.line = ++last_line_;
    if (!inner.is_table()) inner.value = SettingsNode::Table{};
    return set(std::get<SettingsNode::Table>(inner.value), key.substr(dot + 1), std::move(value),
               beside);
  }
  value.where = {"", next_line()};
  if (!beside.empty()) {
    comments_.push_back({value.where.line, "# " + clean_text(beside), true});
  }
  table[std::string(key)] = std::move(value);
}

void TomlDocument::replace(SettingsNode::Table& table, const std::string& key,
                           const std::string& new_key, SettingsNode value) {
  const auto at = table.find(key);
  if (at == table.end()) return set(table, new_key, std::move(value));
  value.where = at->second.where;
  if (value.where.line <= 0) value.where.line = next_line();
  for (std::string& line : pending_) {
    comments_.push_back({value.where.line - 1, std::move(line)});
  }
  pending_.clear();
  table.erase(at);
  table[new_key] = std::move(value);
}

std::string TomlDocument::text() const {
  Writer writer;
  writer.write(std::get<SettingsNode::Table>(root.value), "", 0);
  std::vector<std::vector<std::string>> above(writer.lines.size() + 1);
  std::vector<std::string> beside(writer.lines.size());
  // Finds the written line that belongs to a comment. For a comment beside a value it is the line
  // of this value; for a comment above a value, the line of the next value that was read.
  const auto owner = [&](const Comment& comment) {
    size_t best = writer.lines.size();
    for (size_t i = 0; i < writer.lines.size(); ++i) {
      const int from = writer.lines[i].from;
      if (from <= 0 || (comment.beside ? from > comment.line : from <= comment.line)) continue;
      const bool is_nearer =
          best == writer.lines.size() ||
          (comment.beside ? from >= writer.lines[best].from : from < writer.lines[best].from);
      if (is_nearer) best = i;
    }
    return best;
  };
  for (const Comment& comment : comments_) {
    const size_t line = owner(comment);
    const bool fits_beside = comment.beside && line < beside.size() && beside[line].empty() &&
                             writer.lines[line].from == comment.line;
    if (fits_beside) {
      beside[line] = "  " + comment.text;
    } else {
      above[line].push_back(comment.text);
    }
  }
  std::string text;
  for (const std::string& line : head_) text += line + "\n";
  for (size_t i = 0; i < writer.lines.size(); ++i) {
    if (writer.lines[i].begins_section && !text.empty()) text += "\n";
    for (const std::string& line : above[i]) text += line + "\n";
    text += writer.lines[i].text + beside[i] + "\n";
  }
  std::ranges::copy(pending_, std::back_inserter(above.back()));
  if (!above.back().empty()) text += "\n";
  for (const std::string& line : above.back()) text += line + "\n";
  if (!same_values(parse_toml(text, "the written document"), root)) {
    throw NumericalError("the written document does not read back as its values");
  }
  return text;
}

std::string toml_document(const SettingsNode::Table& root) {
  return TomlDocument(root).text();
}

}  // namespace photorque
