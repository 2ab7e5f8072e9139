#include "diagnosis/guess/guess.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include "attitude/recordings/aem.h"
#include "attitude/recordings/text_lines.h"
#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

// The cells of the header and of some rows of numbers below it.
struct FileHead {
  std::vector<std::string> header;
  std::vector<std::vector<double>> rows;
};

// Accepts a decimal comma if it cannot be the separator.
std::optional<double> number_of_cell(std::string_view cell, char separator) {
  const std::optional<double> number = number_in(cell);
  const size_t comma = cell.find(',');
  if (number || separator == ',' || comma == std::string_view::npos) return number;
  std::string with_point(cell);
  with_point[comma] = '.';
  return number_in(with_point);
}

std::optional<std::vector<double>> numbers_of(const std::vector<std::string_view>& cells,
                                              char separator) {
  std::vector<double> numbers;
  bool any = false;
  for (const std::string_view cell : cells) {
    const std::optional<double> number = number_of_cell(cell, separator);
    if (!number && !cell.empty() && cell != "nan" && cell != "NaN" && cell != "NA") {
      return std::nullopt;
    }
    any = any || number;
    numbers.push_back(number.value_or(NAN));
  }
  if (!any || numbers.size() < 2) return std::nullopt;
  return numbers;
}

// The first lines of a file without comments.
std::vector<std::string> first_lines(const std::filesystem::path& path) {
  constexpr size_t most = 400;
  TextLines lines(path);
  std::vector<std::string> first;
  std::string_view line;
  while (first.size() < most && lines.next(line)) {
    if (first.empty()) require_text(line.substr(0, 16), {path.string(), 1});
    if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    if (trimmed(line).empty() || line.front() == '#') continue;
    first.emplace_back(line);
  }
  return first;
}

std::optional<FileHead> head_with(const std::vector<std::string>& lines, char separator) {
  std::vector<std::string_view> cells, before;
  for (size_t i = 0; i < lines.size(); ++i) {
    split_cells(lines[i], separator, cells);
    if (!numbers_of(cells, separator)) {
      before = cells;
      continue;
    }
    if (i == 0 || before.size() != cells.size()) return std::nullopt;
    FileHead head;
    head.header.assign(before.begin(), before.end());
    for (; i < lines.size(); ++i) {
      split_cells(lines[i], separator, cells);
      const auto row = numbers_of(cells, separator);
      if (row && row->size() == head.header.size()) head.rows.push_back(*row);
    }
    return head;
  }
  return std::nullopt;
}

FileHead head_of(const std::filesystem::path& path) {
  const std::vector<std::string> lines = first_lines(path);
  for (const char separator : {',', ';', '\t', ' '}) {
    if (auto head = head_with(lines, separator)) return *std::move(head);
  }
  std::vector<std::string_view> cells;
  for (const char separator : {',', ';', '\t', ' '}) {
    if (lines.empty()) break;
    split_cells(lines.front(), separator, cells);
    if (!numbers_of(cells, separator)) continue;
    // Names by position: time first, then coordinates or an angle.
    std::string names = "t_s";
    const char* const usual[] = {"x_m", "y_m", "angle_rad"};
    for (size_t k = 1; k < cells.size(); ++k) {
      names += separator;
      names += cells.size() == 2 ? "angle_rad"
               : k < 4           ? usual[k - 1]
                                 : "other_" + std::to_string(k);
    }
    throw InputError({path.string(), 1}, "header", "numbers in the first line",
                     "a line above them that names the columns (sed -i '1i " + names + "' " +
                         path.filename().string() + " puts one there; write what they are)");
  }
  throw InputError({path.string()}, "header",
                   "no rows of numbers between commas, semicolons, tabs or blanks",
                   "a table with a header that names its columns");
}

struct UnitWord {
  const char *written, *suffix;
};

// Units as commonly written; longer ones come before their parts.
constexpr UnitWord unit_words[] = {
    {"rad/s", "rad_s"},   {"rad s-1", "rad_s"},
    {"deg/s", "deg_s"},   {"°/s", "deg_s"},
    {"dps", "deg_s"},     {"rpm", "rpm"},
    {"m/s^2", "m_s2"},    {"m/s2", "m_s2"},
    {"m/s²", "m_s2"},     {"µs", "us"},
    {"us", "us"},         {"ms", "ms"},
    {"sec", "s"},         {"s", "s"},
    {"min", "min"},       {"rad", "rad"},
    {"deg", "deg"},       {"°", "deg"},
    {"mrad", "mrad"},     {"µT", "uT"},
    {"uT", "uT"},         {"nT", "nT"},
    {"T", "T"},           {"arcsec", "arcsec"},
    {"mm", "mm"},         {"cm", "cm"},
    {"m", "m"},           {"seconds", "s"},
    {"second", "s"},      {"milliseconds", "ms"},
    {"minutes", "min"},   {"degrees", "deg"},
    {"degree", "deg"},    {"radians", "rad"},
    {"radian", "rad"},    {"radians/s", "rad_s"},
    {"rad/sec", "rad_s"}, {"degrees/s", "deg_s"},
    {"deg/sec", "deg_s"}, {"degrees/sec", "deg_s"},
    {"rev/min", "rpm"},   {"r/min", "rpm"},
    {"RPM", "rpm"},       {"U/min", "rpm"},
    {"meters", "m"},      {"metres", "m"},
    {"meter", "m"},       {"metre", "m"},
};

// The unit in brackets after a name, and the name without it.
struct NameAndUnit {
  std::string name, unit;
};

NameAndUnit without_unit(const std::string& in_file) {
  const size_t open = in_file.find_first_of("([");
  if (open != std::string::npos) {
    const size_t close = in_file.find_first_of(")]", open);
    const std::string inside = in_file.substr(open + 1, close - open - 1);
    for (const UnitWord& word : unit_words) {
      if (inside == word.written) return {in_file.substr(0, open), word.suffix};
    }
    return {in_file, ""};
  }
  const KeyUnit key = unit_of_key(in_file);
  return {key.stem, std::string(key.unit)};
}

// Lower-case groups of letters or of digits: "gyroADC[0]" → "gyro", "adc", "0".
std::vector<std::string> words_of_name(const std::string& name) {
  std::vector<std::string> words;
  char before = ' ';
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    const bool letter = std::isalpha(u) != 0, digit = std::isdigit(u) != 0;
    if (letter || digit) {
      const auto b = static_cast<unsigned char>(before);
      const bool goes_on =
          letter ? std::isalpha(b) != 0 && !(std::isupper(u) != 0 && std::islower(b) != 0)
                 : std::isdigit(b) != 0;
      if (!goes_on) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(u));
    }
    before = c;
  }
  return words;
}

bool begins(const std::string& word, std::initializer_list<const char*> with) {
  return std::any_of(with.begin(), with.end(), [&](const char* w) { return word.starts_with(w); });
}

bool is_one_of(const std::string& word, std::initializer_list<const char*> of) {
  return std::any_of(of.begin(), of.end(), [&](const char* w) { return word == w; });
}

// x, y or z: a separate word, a number from 0, or the last letter of another.
std::string axis_of(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (is_one_of(word, {"x", "y", "z"})) return word;
  }
  for (const std::string& word : words) {
    std::string last = word.substr(word.size() - 1);
    if (is_one_of(last, {"x", "y", "z"}) &&
        begins(word, {"w", "gyr", "omega", "acc", "mag", "rate"})) {
      return last;
    }
    if (is_one_of(word, {"0", "1", "2"})) return std::string(1, "xyz"[word[0] - '0']);
  }
  return "";
}

// Channel without its unit, and the unit to assume if none is stated; empty: unknown.
struct MeantQuantity {
  std::string stem, usual_unit;
};

MeantQuantity quantity_of(const std::vector<std::string>& words) {
  const auto any = [&](auto... with) {
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& w) { return begins(w, {with...}); });
  };
  const std::string axis = axis_of(words);
  if (any("wheel", "flywheel", "rotor")) return {"wheel_" + (axis.empty() ? "z" : axis), "rad_s"};
  // Words in English, German, French, Spanish and Italian, without accented letters.
  if (any("time", "sec", "elapsed", "clock", "zeit", "temps", "tiempo", "tempo") ||
      (words.size() == 1 && words[0] == "t")) {
    return {"t", "s"};
  }
  if (any("magnitude", "norm", "modulus") &&
      any("gyr", "omega", "ang", "rate", "spin", "speed", "w")) {
    return {"rate_magnitude", "rad_s"};
  }
  // A coordinate: x, or "pos_x", "puck x".
  if (is_one_of(axis, {"x", "y"}) && (words == std::vector<std::string>{axis} ||
                                      any("pos", "coord", "place", "puck", "cent", "ort"))) {
    return {axis, "m"};
  }
  if (any("acc")) return {axis.empty() ? "" : "accel_" + axis, "m_s2"};
  if (any("mag") || (words.size() <= 2 && any("b") && !axis.empty())) {
    return {axis.empty() ? "" : "mag_" + axis, "T"};
  }
  if (any("gyr", "omega", "angvel", "angular") ||
      (!axis.empty() && (any("rate") || is_one_of(words[0], {"w", "wx", "wy", "wz"})))) {
    return {axis.empty() ? "rate" : "gyro_" + axis, "rad_s"};
  }
  for (const char* angle : {"roll", "pitch", "yaw", "tilt"}) {
    if (any(angle)) return {angle, "rad"};
  }
  if (any("heading", "azimuth")) return {"yaw", "rad"};
  if (any("inclination")) return {"tilt", "rad"};
  if (any("angle", "theta", "encoder", "phi", "winkel", "angul", "ngulo", "angolo")) {
    return {"angle", "rad"};
  }
  if (any("rate", "speed", "rpm", "veloc", "drehzahl", "vitesse", "winkelgeschw")) {
    return {"rate", "rad_s"};
  }
  return {};
}

// q0 … q3, qw … qz, "quaternion w".
std::string quaternion_of(const std::vector<std::string>& words) {
  if (words.empty() || words[0][0] != 'q') return "";
  const std::string part = words[0].size() == 2 ? words[0].substr(1)
                           : words.size() > 1   ? words.back()
                                                : "";
  if (is_one_of(part, {"w", "x", "y", "z"})) return "q_" + part;
  if (is_one_of(part, {"0", "1", "2", "3"})) return std::string("q_") + "wxyz"[part[0] - '0'];
  return "";
}

// A clock with large integer steps does not count seconds.
std::string clock_unit(const FileHead& head, size_t column) {
  std::vector<double> steps;
  for (size_t i = 1; i < head.rows.size(); ++i) {
    const double step = head.rows[i][column] - head.rows[i - 1][column];
    if (std::isfinite(step)) steps.push_back(step);
  }
  if (steps.empty()) return "s";
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const bool whole =
      std::all_of(steps.begin(), steps.end(), [](double s) { return s == std::round(s); });
  return whole && *middle >= 200.0 ? "us" : whole && *middle >= 2.0 ? "ms" : "s";
}

GuessedColumn guessed(const FileHead& head, size_t column) {
  const std::string& in_file = head.header[column];
  const auto [name, unit] = without_unit(in_file);
  const std::vector<std::string> words = words_of_name(name);
  GuessedColumn guess{in_file, ""};
  if (words.empty()) return guess;
  if (const std::string q = quaternion_of(words); !q.empty()) {
    guess.channel = q;
    return guess;
  }
  MeantQuantity quantity = quantity_of(words);
  if (quantity.stem.empty()) return guess;
  // "|omega|"
  if (quantity.stem == "rate" && name.starts_with("|")) quantity.stem = "rate_magnitude";
  const std::string usual = quantity.stem == "t" ? clock_unit(head, column) : quantity.usual_unit;
  guess.channel = quantity.stem + "_" + (unit.empty() ? usual : unit);
  const bool fits = unit_of_key(guess.channel).dimension ==
                    unit_of_key(quantity.stem + "_" + quantity.usual_unit).dimension;
  if (!fits) return {in_file, ""};
  guess.is_sure = !unit.empty();
  if (unit.empty()) guess.because = "the header states no unit";
  return guess;
}

}  // namespace

std::vector<GuessedColumn> guess_columns(const std::filesystem::path& path) {
  if (is_message(path, "AEM"))
    return {{"q_w", "q_w"}, {"q_x", "q_x"}, {"q_y", "q_y"}, {"q_z", "q_z"}};
  const FileHead head = head_of(path);
  std::vector<GuessedColumn> all;
  for (size_t column = 0; column < head.header.size(); ++column) {
    GuessedColumn guess = guessed(head, column);
    // Every channel occurs once: the first column with its name.
    const bool taken = std::any_of(all.begin(), all.end(), [&](const GuessedColumn& other) {
      return !guess.channel.empty() &&
             unit_of_key(other.channel).stem == unit_of_key(guess.channel).stem;
    });
    if (taken) guess.channel.clear();
    all.push_back(std::move(guess));
  }
  return all;
}

}  // namespace photorque
