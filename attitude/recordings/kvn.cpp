#include "attitude/recordings/kvn.h"

#include <algorithm>
#include <array>

#include "attitude/recordings/text_lines.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
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

const KvnItem* KvnItem::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) {
    for (const KvnItem& item : items) {
      if (item.kind == Kind::assignment && item.key == name) return &item;
    }
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

std::string kvn_text(const KvnItem& message) {
  std::string text;
  append(text, message);
  return text;
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

// Converts the values of keywords that select among names. Other texts are kept as written.
void take_words(KvnItem& block) {
  constexpr std::array<std::string_view, 5> keywords = {"FRAME", "_DIR", "_TYPE", "_SEQ",
                                                        "TIME_SYSTEM"};
  for (KvnItem& item : block.items) {
    if (item.kind == KvnItem::Kind::block) take_words(item);
    if (std::ranges::any_of(keywords, [&item](std::string_view part) {
          return item.key.find(part) != std::string::npos;
        })) {
      item.value = kvn_word(item.value);
    }
  }
}

}  // namespace

std::string kvn_word(std::string_view text) {
  std::string word = joined_text(words_of(text, " \t\r\n\v\f"), "_");
  std::ranges::transform(word, word.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return word;
}

std::vector<std::string> kinds_of_messages(const std::filesystem::path& path) {
  constexpr std::string_view begin = "CCSDS_", end = "_VERS";
  constexpr size_t letters = 3;
  const std::string words = first_words(path);
  if (words.starts_with(begin) && words.find(end) == begin.size() + letters) {
    return {words.substr(begin.size(), letters)};
  }
  std::vector<std::string> kinds;
  if (!words.starts_with("<")) return kinds;
  try {
    const std::string text = read_file(path);
    for (const char* kind :
         {"AEM", "APM", "ACM", "OEM", "OPM", "OMM", "OCM", "CDM", "RDM", "TDM"}) {
      if (text.find("<" + lower_case(kind)) != std::string::npos) kinds.emplace_back(kind);
    }
  } catch (const InputError&) {
    // The reader of the file reports its errors.
  }
  return kinds;
}

MessageFile::MessageFile(const std::filesystem::path& file, const std::string& kind)
    : path(file),
      message(first_words(file).starts_with("<") ? read_ndm_xml(file, kind) : Parser(file).read()) {
  take_words(message);
}

InputError MessageFile::error(const KvnItem& at, const std::string& key, const std::string& found,
                              const std::string& expected) const {
  return {{path.string(), at.line}, key, found, expected};
}

const KvnItem& MessageFile::required(const KvnItem& block,
                                     std::initializer_list<std::string_view> names) const {
  if (const KvnItem* item = block.find(names)) return *item;
  throw error(block, std::string(*names.begin()), "nothing", "a value");
}

MessageFile::Row MessageFile::row(const KvnItem& item) const {
  if (item.kind != KvnItem::Kind::data) {
    throw error(item, "", in_quotes(item.key), "rows of an epoch and numbers");
  }
  const std::vector<std::string_view> words = words_of(item.value);
  if (words.empty()) throw error(item, "", "an empty row", "an epoch and numbers");
  Row row{std::string(words.front()), {}};
  for (size_t i = 1; i < words.size(); ++i) {
    row.numbers.push_back(require_number(words[i], {path.string(), item.line}, ""));
  }
  return row;
}

Epoch MessageFile::epoch(const std::string& text, const std::string& key, const KvnItem& at) const {
  const std::optional<Epoch> time = parse_epoch(text);
  if (!time) throw error(at, key, in_quotes(text), "a time as 2000-01-01T12:00:00");
  return *time;
}

Epoch MessageFile::utc(const Epoch& time, const std::string& system, const KvnItem& at) const {
  const std::optional<Epoch> utc = to_utc(time, system);
  if (!utc) throw error(at, "TIME_SYSTEM", in_quotes(system), "UTC, UT1, TAI, TT or GPS");
  return *utc;
}

std::optional<std::array<int, 3>> axes_of_sequence(std::string_view sequence) {
  std::array<int, 3> axes{};
  if (sequence.size() != axes.size()) return std::nullopt;
  for (size_t i = 0; i < axes.size(); ++i) {
    const char c = sequence[i];
    axes[i] = c >= 'X' && c <= 'Z' ? c - 'X' : c - '1';
    if (axes[i] < 0 || axes[i] > 2) return std::nullopt;
  }
  return axes;
}

}  // namespace photorque
