#include "attitude/recordings/kvn.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/recordings/text_lines.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {

namespace {

constexpr std::string_view start = "_START", stop = "_STOP", comment = "COMMENT";

KvnItem parse_assignment(std::string_view line, size_t equals) {
  KvnItem item{.kind = KvnItem::Kind::assignment,
               .key = std::string(trimmed(line.substr(0, equals)))};
  std::string_view value = trimmed(line.substr(equals + 1));
  const size_t bracket = value.rfind('[');
  if (value.ends_with(']') && bracket != std::string_view::npos) {
    item.unit = trimmed(value.substr(bracket + 1, value.size() - bracket - 2));
    value = trimmed(value.substr(0, bracket));
  }
  item.value = value;
  return item;
}

bool is_comment(std::string_view line) {
  return line.starts_with(comment) && (line.size() == comment.size() ||
                                       line[comment.size()] == ' ' || line[comment.size()] == '\t');
}

// Reads a block's lines up to its end.
class Parser {
 public:
  explicit Parser(const std::filesystem::path& path) : path_(path), lines_(path) {}

  KvnItem read() {
    KvnItem message;
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
      if (line.empty() || is_comment(line)) continue;
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
    const size_t equals = line.find('=');
    if (equals != std::string_view::npos) {
      KvnItem item = parse_assignment(line, equals);
      item.line = number;
      return item;
    }
    if (line.ends_with(start)) {
      KvnItem inner{.key = std::string(line.substr(0, line.size() - start.size())), .line = number};
      fill(inner, depth + 1);
      return inner;
    }
    // Rows of an OEM follow its metadata without a block. They start with the year of an epoch.
    const bool is_row = line.front() >= '0' && line.front() <= '9';
    if (block.key.empty() && !is_row) throw error(in_quotes(line), "a keyword = value");
    return {.kind = KvnItem::Kind::data, .value = std::string(line), .line = number};
  }

  std::filesystem::path path_;
  TextLines lines_;
};

}  // namespace

const KvnItem* KvnItem::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) {
    for (const KvnItem& item : items) {
      if (item.kind == Kind::assignment && item.key == name) return &item;
    }
  }
  return nullptr;
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

Quat MessageFile::unit(const Quat& q, const KvnItem& at, const std::string& key) const {
  constexpr double tolerance = 0.01;
  if (std::abs(q.norm() - 1.0) < tolerance) return q.normalized();
  throw error(at, key, "a quaternion of norm " + shortest(q.norm()), "unit norm");
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

Quat successive_rotations(const std::array<int, 3>& axes, const Vec3& angles_rad, int first) {
  Quat q = Quat::Identity();
  for (int i = first; i < 3; ++i) {
    q = q * Quat(Eigen::AngleAxisd(angles_rad[i], Vec3::Unit(axes[static_cast<size_t>(i)])));
  }
  return q;
}

FrameAxes axes_of_frame(std::string_view frame) {
  if (frame == "EME2000" || frame == "J2000" || frame == "GCRF" || frame.starts_with("ICRF")) {
    return FrameAxes::J2000;
  }
  if (frame.starts_with("TOD") || frame.starts_with("MOD") || frame.starts_with("TEME")) {
    return FrameAxes::of_date;
  }
  return frame.starts_with("ITRF") ? FrameAxes::earth : FrameAxes::unknown;
}

namespace {

// Whether a frame is fixed in the body: SC_BODY, STARTRACKER_2…
bool is_body_frame(std::string_view frame) {
  constexpr std::array<std::string_view, 16> parts = {
      "ACC",        "ACTUATOR", "AST", "CSS", "DSS",    "ESA",     "GYRO_FRAME",  "IMU_FRAME",
      "INSTRUMENT", "MTA",      "RW",  "SA",  "SENSOR", "SC_BODY", "STARTRACKER", "TAM"};
  // The number or letter of the part follows, as in SENSOR_1.
  return std::ranges::any_of(parts, [frame](std::string_view part) {
    if (!frame.starts_with(part)) return false;
    const std::string_view rest = frame.substr(part.size());
    return rest.empty() || rest.front() == '_' || (rest.front() >= '0' && rest.front() <= '9');
  });
}

}  // namespace

FramePair::FramePair(const std::string& frame_a, const std::string& frame_b,
                     const InputLocation& where)
    : a(frame_a), b(frame_b), is_from_body(is_body_frame(a)) {
  const FrameAxes axes = axes_of_frame(lab());
  // MCI: inertial about Mars. LVLH_INERTIAL and the like: those of an orbit at one instant.
  const bool is_still = lab().starts_with("LAB") || lab().ends_with("INERTIAL") ||
                        lab() == "B1950" || lab() == "MCI" || axes == FrameAxes::J2000 ||
                        axes == FrameAxes::of_date;
  if (is_body_frame(b) != is_from_body && is_still) return;
  throw InputError(where, "", "the frames " + in_quotes(a) + " and " + in_quotes(b),
                   "one of the body (SC_BODY_1) and one of space: inertial (EME2000, J2000, GCRF, "
                   "ICRF, TOD, MOD, TEME, B1950, MCI) or LAB");
}

bool are_axes_of_a(const std::string& frame, const std::string& a, const std::string& b,
                   const InputLocation& where) {
  if (frame == "REF_FRAME_A" || frame == a) return true;
  if (frame == "REF_FRAME_B" || frame == b) return false;
  throw InputError(where, "ANGVEL_FRAME", frame.empty() ? "nothing" : in_quotes(frame),
                   "one of the two frames, " + in_quotes(a) + " or " + in_quotes(b));
}

}  // namespace photorque
