// IES LM-63: "Standard file format for the electronic transfer of photometric data", of 1986, 1991,
// 1995, 2002 and 2019.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/text/parse.h"
#include "sources/photometry/file.h"

namespace photorque {
namespace {

constexpr double foot_m = 0.3048;

bool begins_with_word(std::string_view line, std::string_view word) {
  return line.size() >= word.size() &&
         std::equal(word.begin(), word.end(), line.begin(), [](char a, char b) {
           return a == std::toupper(static_cast<unsigned char>(b));
         });
}

// A line "TILT=" in any case, with optional blanks before the sign. "Tilting bracket" is not one.
bool is_tilt_line(std::string_view line) {
  return begins_with_word(line, "TILT") && trimmed(line.substr(4)).starts_with('=');
}

// "IESNA:LM-63-2002" or "IES:LM-63-2019", but not a company name that begins with these letters.
bool begins_as_ies(std::string_view line) {
  return begins_with_word(line, "IESNA") || begins_with_word(line, "IES:");
}

// The numbers after the TILT line, separated by any mixture of blanks, commas and line ends.
class NumberStream {
 public:
  NumberStream(const std::vector<std::string_view>& lines, size_t line, const std::string& file)
      : lines_(lines), line_(line), file_(file) {}

  InputLocation where() const {
    return {file_, static_cast<int>(std::min(line_ + 1, lines_.size()))};
  }

  // Location of the line after the last number.
  InputLocation line_after() const {
    return {file_, static_cast<int>(std::min(line_ + 2, lines_.size()))};
  }

  double next(const char* what) {
    const std::string_view word = next_word();
    if (word.empty()) throw InputError(where(), what, "the end of the file", "a number");
    return require_number(word, where(), what);
  }

  size_t count(const char* what, int low, int high) {
    const double value = next(what);
    return require_count(value, where(), what, low, high);
  }

  // A count cannot cause a large allocation: reading stops with an error at the end of the file.
  std::vector<double> numbers(const char* what, size_t count) {
    std::vector<double> values;
    for (size_t i = 0; i < count; ++i) values.push_back(next(what));
    return values;
  }

  // The next word if it is a number.
  std::optional<double> left_over() { return number_in(next_word()); }

  // Number of remaining words.
  size_t left() const {
    NumberStream rest = *this;
    size_t words = 0;
    while (!rest.next_word().empty()) ++words;
    return words;
  }

 private:
  std::string_view next_word() {
    constexpr std::string_view separators = " \t,\v\f\x1a";
    for (; line_ < lines_.size(); ++line_, at_ = 0) {
      const size_t first = lines_[line_].find_first_not_of(separators, at_);
      if (first == std::string_view::npos) continue;
      at_ = std::min(lines_[line_].find_first_of(separators, first), lines_[line_].size());
      return lines_[line_].substr(first, at_ - first);
    }
    return {};
  }

  const std::vector<std::string_view>& lines_;
  size_t line_;
  size_t at_ = 0;
  const std::string& file_;
};

// Reads the lines above TILT: a version, and keywords or (1986) free text. Returns the index of the
// TILT line.
size_t read_labels(const std::vector<std::string_view>& lines, const std::string& name,
                   PhotometricFile& file) {
  file.format = "LM-63-1986";
  for (size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (is_tilt_line(line)) return i;
    if (i == 0 && begins_as_ies(line)) {
      file.format = std::string(line);
    } else if (line.starts_with('[') && line.find(']') != std::string_view::npos) {
      const size_t end = line.find(']');
      file.labels.emplace_back(line.substr(1, end - 1), trimmed(line.substr(end + 1)));
    } else if (!line.empty()) {
      file.labels.emplace_back("", line);
    }
  }
  throw InputError({name, static_cast<int>(lines.size())}, "TILT", "no such line",
                   "a TILT= line after the keywords");
}

void read_tilt(std::string_view line, NumberStream& stream, PhotometricFile& file) {
  const size_t equals = line.find('=');
  const std::string_view value =
      equals == std::string_view::npos ? "" : trimmed(line.substr(equals + 1));
  if (begins_with_word(value, "NONE")) return;
  if (begins_with_word(value, "INCLUDE")) {
    stream.count("TILT lamp geometry", 1, 3);
    const size_t angles = stream.count("TILT angles", 1, 100000);
    require_ascending(stream.numbers("TILT angle", angles), "TILT angles", stream.where());
    stream.numbers("TILT factor", angles);
    file.notices.emplace_back("TILT factors (a lamp that dims when tilted) are not applied");
    return;
  }
  if (value.empty()) throw InputError(stream.where(), "TILT", "nothing", "NONE, INCLUDE or a file");
  file.notices.push_back("the TILT file \"" + std::string(value) +
                         "\" (a lamp that dims when tilted) is not applied");
}

// Opening by Table 1 of LM-63-2002; before 2002 only a negative width means a disc.
Opening read_opening(double width_m, double length_m, double height_m, PhotometricFile& file) {
  if (height_m != 0.0) {
    file.notices.emplace_back(
        "the height of the luminous opening is ignored: the light source is flat");
  }
  Opening opening;
  opening.x_m = std::abs(length_m);
  opening.y_m = std::abs(width_m);
  if (length_m == 0.0 && width_m < 0.0) opening.x_m = opening.y_m;
  if (width_m == 0.0 && length_m < 0.0) opening.y_m = opening.x_m;
  if (opening.x_m == 0.0 && opening.y_m == 0.0) return opening;
  opening.shape =
      width_m < 0.0 || length_m < 0.0 ? Opening::Shape::ellipse : Opening::Shape::rectangle;
  return opening;
}

struct IesHeader {
  size_t type = 1;  // 1 C, 2 B, 3 A
  size_t vertical = 0, horizontal = 0;
  double factor = 1.0;
};

IesHeader read_header(NumberStream& stream, PhotometricFile& file) {
  IesHeader header;
  const double lamps = stream.next("number of lamps");
  const double lumens = stream.next("lumens per lamp");
  const double multiplier = stream.next("candela multiplier");
  const InputLocation multiplier_at = stream.where();
  header.vertical = stream.count("number of vertical angles", 2, 100000);
  header.horizontal = stream.count("number of horizontal angles", 1, 100000);
  header.type = stream.count("photometric type", 1, 3);
  const double unit_m = stream.count("units type", 1, 2) == 1 ? foot_m : 1.0;
  const double width_m = unit_m * stream.next("width");
  const double length_m = unit_m * stream.next("length");
  file.opening = read_opening(width_m, length_m, unit_m * stream.next("height"), file);
  require_opening(file.opening, stream.where());
  const size_t table = header.vertical + header.horizontal + header.vertical * header.horizontal;
  if (stream.left() == table) {
    throw InputError(stream.line_after(), "ballast factor", "no such line",
                     "a line with the ballast factor, the ballast-lamp factor and the input watts");
  }
  const double ballast = stream.next("ballast factor");
  const InputLocation ballast_at = stream.where();
  const double future = stream.next("ballast-lamp factor");
  file.input_power_W = stream.next("input watts");
  // In the version of 2019 the second factor is a code for the kind of test instead.
  const bool is_factor = file.format.find("2019") == std::string::npos && future > 0.0;
  header.factor = multiplier * ballast * (is_factor ? future : 1.0);
  if (!(header.factor > 0.0)) {
    const bool is_ballast = multiplier > 0.0;
    throw InputError(is_ballast ? ballast_at : multiplier_at,
                     is_ballast ? "ballast factor" : "candela multiplier",
                     shortest(is_ballast ? ballast : multiplier), "a number > 0");
  }
  if (lumens >= 0.0 && std::isfinite(lamps * lumens)) file.stated_flux_lm = lamps * lumens;
  return header;
}

// If a count is too low, numbers remain at the end, and all values before are assigned wrongly.
void require_end(NumberStream& stream, const IesHeader& header) {
  const std::optional<double> left = stream.left_over();
  if (!left) return;
  throw InputError(stream.where(), "number of vertical angles",
                   std::to_string(header.vertical) + " by " + std::to_string(header.horizontal) +
                       " horizontal ones, and numbers after the last candela value (" +
                       shortest(*left) + ")",
                   "counts that agree with the table");
}

}  // namespace

bool looks_like_ies(const std::vector<std::string_view>& lines) {
  const auto first = std::ranges::find_if(lines, [](auto line) { return !trimmed(line).empty(); });
  if (first != lines.end() && begins_as_ies(trimmed(*first))) return true;
  return std::ranges::any_of(lines, [](auto line) { return is_tilt_line(trimmed(line)); });
}

PhotometricFile read_ies(const std::string& bytes, const std::string& name) {
  PhotometricFile file;
  const std::vector<std::string_view> lines = lines_of(bytes);
  const size_t tilt = read_labels(lines, name, file);
  NumberStream stream(lines, tilt + 1, name);
  read_tilt(trimmed(lines[tilt]), stream, file);
  const IesHeader header = read_header(stream, file);
  StoredPlanes stored;
  stored.polar_deg = stream.numbers("vertical angle", header.vertical);
  require_ascending(stored.polar_deg, "vertical angles", stream.where());
  const InputLocation angles_at = stream.where();
  stored.azimuth_deg = stream.numbers("horizontal angle", header.horizontal);
  require_ascending(stored.azimuth_deg, "horizontal angles", stream.where());
  for (size_t i = 0; i < header.horizontal * header.vertical; ++i) {
    stored.intensity.push_back(header.factor * stream.next("candela value"));
    if (!std::isfinite(stored.intensity.back())) {
      throw InputError(stream.where(), "candela value", "a number that overflows",
                       "a finite intensity");
    }
  }
  require_end(stream, header);
  if (header.type == 1) {
    require_goniometer_range(stored.polar_deg, angles_at);
    file.table = unfold(stored, implied_symmetry(stored.azimuth_deg), stream.where());
  } else {
    const Pole pole = header.type == 2 ? Pole::horizontal : Pole::vertical;
    file.table = sideways_table(pole, stored, angles_at);
  }
  require_light(file, stream.where());
  note_gaps(file);
  return file;
}

}  // namespace photorque
