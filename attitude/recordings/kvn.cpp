#include "attitude/recordings/kvn.h"

#include <algorithm>

#include "attitude/recordings/text_lines.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/parse.h"

namespace photorque {

namespace {

constexpr std::string_view start = "_START", stop = "_STOP", comment = "COMMENT";

KvnItem parse_assignment(std::string_view line, size_t equals) {
  KvnItem item;
  item.kind = KvnItem::Kind::assignment;
  item.key = trimmed(line.substr(0, equals));
  std::string_view value = trimmed(line.substr(equals + 1));
  const size_t bracket = value.rfind('[');
  if (value.ends_with(']') && bracket != std::string_view::npos) {
    item.unit = trimmed(value.substr(bracket + 1, value.size() - bracket - 2));
    value = trimmed(value.substr(0, bracket));
  }
  item.value = value;
  return item;
}

// Reads a block's lines up to its end.
class Parser {
 public:
  explicit Parser(const std::filesystem::path& path) : path_(path), lines_(path) {}

  KvnItem read() {
    KvnItem message = kvn_block("");
    fill(message, 0);
    return message;
  }

 private:
  InputError error(const std::string& found, const std::string& expected) const {
    return {{path_.string(), static_cast<int>(lines_.number())}, "", found, expected};
  }

  void fill(KvnItem& block, int depth) {
    constexpr int deepest = 8;
    if (depth > deepest) throw error("blocks within blocks within blocks", "a CCSDS message");
    std::string_view raw;
    while (lines_.next(raw)) {
      const std::string_view line = trimmed(raw);
      if (line.empty()) continue;
      if (line.find('=') == std::string_view::npos && line.ends_with(stop)) {
        if (block.key + std::string(stop) == line) return;
        throw error(std::string(line), block.key.empty() ? "a block" : block.key + "_STOP");
      }
      block.items.push_back(parse(line, block, depth));
    }
    if (!block.key.empty()) throw error("the end of the file", block.key + std::string(stop));
  }

  KvnItem parse(std::string_view line, const KvnItem& block, int depth) {
    const int number = static_cast<int>(lines_.number());
    const auto located = [number](KvnItem item) {
      item.line = number;
      return item;
    };
    if (line.starts_with(comment) &&
        (line.size() == comment.size() || line[comment.size()] == ' ' ||
         line[comment.size()] == '\t')) {
      return located(kvn_comment(std::string(trimmed(line.substr(comment.size())))));
    }
    const size_t equals = line.find('=');
    if (equals != std::string_view::npos) return located(parse_assignment(line, equals));
    if (line.ends_with(start)) {
      KvnItem inner = located(kvn_block(std::string(line.substr(0, line.size() - start.size()))));
      fill(inner, depth + 1);
      return inner;
    }
    // Rows of an OEM follow its metadata without a block. They start with the year of an epoch.
    const bool is_row = line.front() >= '0' && line.front() <= '9';
    if (block.key.empty() && !is_row) throw error(in_quotes(line), "a keyword = value");
    return located(kvn_data(std::string(line)));
  }

  std::filesystem::path path_;
  TextLines lines_;
};

void append(std::string& text, const KvnItem& block) {
  size_t widest = 0;
  for (const KvnItem& item : block.items) {
    if (item.kind == KvnItem::Kind::assignment) widest = std::max(widest, item.key.size());
  }
  for (const KvnItem& item : block.items) {
    switch (item.kind) {
      case KvnItem::Kind::comment:
        text += std::string(comment) + (item.value.empty() ? "" : " " + item.value) + "\n";
        break;
      case KvnItem::Kind::assignment:
        text += item.key + std::string(widest - item.key.size(), ' ') + " = " + item.value;
        text += (item.unit.empty() ? "" : " [" + item.unit + "]") + "\n";
        break;
      case KvnItem::Kind::data:
        text += item.value + "\n";
        break;
      case KvnItem::Kind::block:
        text += "\n" + item.key + std::string(start) + "\n";
        append(text, item);
        text += item.key + std::string(stop) + "\n";
        break;
    }
  }
}

}  // namespace

const std::string* KvnItem::find(std::string_view name) const {
  for (const KvnItem& item : items) {
    if (item.kind == Kind::assignment && item.key == name) return &item.value;
  }
  return nullptr;
}

KvnItem kvn_comment(const std::string& text) {
  return {KvnItem::Kind::comment, "", text, "", {}, 0};
}
KvnItem kvn_assignment(const std::string& key, const std::string& value, const std::string& unit) {
  return {KvnItem::Kind::assignment, key, value, unit, {}, 0};
}
KvnItem kvn_data(const std::string& line) {
  return {KvnItem::Kind::data, "", line, "", {}, 0};
}
KvnItem kvn_block(const std::string& name) {
  return {KvnItem::Kind::block, name, "", "", {}, 0};
}

KvnItem read_kvn(const std::filesystem::path& path) {
  return Parser(path).read();
}

std::string kvn_text(const KvnItem& message) {
  std::string text;
  append(text, message);
  return text;
}

void write_kvn(const std::filesystem::path& path, const KvnItem& message) {
  write_file_whole(path, kvn_text(message));
}

std::vector<double> kvn_numbers(const std::vector<std::string_view>& words, size_t first,
                                const std::filesystem::path& path, int line) {
  std::vector<double> numbers;
  for (size_t i = first; i < words.size(); ++i) {
    numbers.push_back(require_number(words[i], {path.string(), line}, ""));
  }
  return numbers;
}

namespace {

// The first line that is neither empty nor a comment, without a byte-order mark; empty if the file
// cannot be read.
std::string first_words(const std::filesystem::path& path) {
  constexpr int first_lines = 100;
  try {
    TextLines lines(path);
    std::string_view line;
    for (int i = 0; i < first_lines && lines.next(line); ++i) {
      const std::string_view words = trimmed(line);
      if (!words.empty() && !words.starts_with(comment)) return std::string(words);
    }
  } catch (const InputError&) {
    // The reader of the file reports its errors.
  }
  return "";
}

}  // namespace

KvnItem read_message(const std::filesystem::path& path) {
  return first_words(path).starts_with("<") ? read_ndm_xml(path) : read_kvn(path);
}

bool is_message(const std::filesystem::path& path, const std::string& kind) {
  const std::string words = first_words(path);
  if (!words.starts_with("<")) return words.starts_with("CCSDS_" + kind + "_VERS");
  const std::string element = "<" + lower_case(kind);
  try {
    return read_file(path).find(element) != std::string::npos;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace photorque
