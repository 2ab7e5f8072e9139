#include "receivers/wrench/spad.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

struct Line {
  int number = 0;  // 1-based
  std::string_view text;
};

struct Motion {
  double low_deg = 0.0, high_deg = 0.0, step_deg = 0.0;

  size_t nodes() const {
    return static_cast<size_t>(std::lround((high_deg - low_deg) / step_deg)) + 1;
  }
  std::vector<double> angles_rad() const {
    std::vector<double> angles;
    for (size_t i = 0; i < nodes(); ++i) {
      angles.push_back((low_deg + static_cast<double>(i) * step_deg) * degree_rad);
    }
    return angles;
  }
  // The node of an angle, if it is one (to the digits that files have).
  std::optional<size_t> node_of(double angle_deg) const {
    const double position = (angle_deg - low_deg) / step_deg;
    const double nearest = std::round(position);
    if (std::abs(position - nearest) * step_deg > 0.006 || nearest < 0.0 ||
        nearest >= static_cast<double>(nodes())) {
      return std::nullopt;
    }
    return static_cast<size_t>(nearest);
  }
};

struct Header {
  std::string system;
  Vec3 centre_of_mass_m = Vec3::Zero();
  std::map<std::string, Motion> motions;
};

// Reads the lines of one file and says where it is.
class Reader {
 public:
  Reader(std::string_view text, std::string name) : name_(std::move(name)) {
    int number = 0;
    for (const std::string_view line : lines_of(text)) lines_.push_back({++number, trimmed(line)});
  }

  // The next line that is neither empty nor a row of dashes; none at the end.
  std::optional<Line> next() {
    while (position_ < lines_.size()) {
      const Line& line = lines_[position_++];
      if (line.text.find_first_not_of("- ") != std::string::npos) return line;
    }
    return std::nullopt;
  }
  Line require(const std::string& expected) {
    if (std::optional<Line> line = next()) return *line;
    throw InputError({name_, static_cast<int>(lines_.size())}, "", "the end of the file", expected);
  }
  // Lines at most.
  size_t left() const { return lines_.size() - position_; }
  InputError error(const Line& line, const std::string& expected) const {
    return {{name_, line.number}, "", in_quotes(line.text), expected};
  }
  double number(const Line& line, std::string_view word, const std::string& what) const {
    return require_number(word, {name_, line.number}, what, "a finite number");
  }

 private:
  std::string name_;
  std::vector<Line> lines_;
  size_t position_ = 0;
};

Vec3 read_point(const Reader& reader, const Line& line, std::string_view text) {
  const std::vector<std::string_view> words = words_of(text, " \t(),");
  if (words.size() != 3) throw reader.error(line, "a centre of mass (x, y, z)");
  Vec3 point;
  for (int i = 0; i < 3; ++i) {
    point[i] = reader.number(line, words[static_cast<size_t>(i)], "Center of Mass");
  }
  return point;
}

void check_motion(const Reader& reader, const Line& line, const std::string& name,
                  const Motion& motion) {
  const double steps = (motion.high_deg - motion.low_deg) / motion.step_deg;
  const bool whole = motion.step_deg > 0.0 && steps >= 1.0 && steps <= 1e5 &&
                     std::abs(steps - std::round(steps)) < 1e-6;
  if (!whole) {
    throw reader.error(line,
                       "for " + name + " a positive step that divides Minimum to Maximum evenly");
  }
}

Header read_header(Reader& reader) {
  Header header;
  std::string motion;
  bool ended = false;
  while (!ended) {
    const Line line = reader.require("\": END\" after the ranges of the motions");
    const size_t colon = line.text.find(':');
    if (colon == std::string::npos) throw reader.error(line, "a line \"Key : value\"");
    const std::string key(trimmed(line.text.substr(0, colon)));
    const std::string value(trimmed(line.text.substr(colon + 1)));
    if (key.empty() && value == "END") ended = true;
    if (key == "System") header.system = value;
    if (key == "Center of Mass") header.centre_of_mass_m = read_point(reader, line, value);
    if (key == "Analysis Type" && value != "Area") throw reader.error(line, "the type Area");
    if (key == "Name") motion = value;
    if (key == "Minimum") header.motions[motion].low_deg = reader.number(line, value, key);
    if (key == "Maximum") header.motions[motion].high_deg = reader.number(line, value, key);
    if (key == "Step") {
      header.motions[motion].step_deg = reader.number(line, value, key);
      check_motion(reader, line, motion, header.motions[motion]);
    }
    if (ended && !(header.motions.size() == 2 && header.motions.contains("Azimuth") &&
                   header.motions.contains("Elevation"))) {
      throw reader.error(line, "the two motions Azimuth and Elevation before this line");
    }
    // Again: a range may have been changed after its step, or have none.
    for (const auto& [name, range] : header.motions) {
      if (ended) check_motion(reader, line, name, range);
    }
  }
  return header;
}

size_t read_count(Reader& reader) {
  const Line line = reader.require("\"Record count : N\"");
  const size_t colon = line.text.find(':');
  if (!line.text.starts_with("Record count") || colon == std::string::npos) {
    throw reader.error(line, "\"Record count : N\"");
  }
  const double count = reader.number(line, trimmed(line.text.substr(colon + 1)), "Record count");
  if (!(count >= 1 && count <= 1e9 && count == std::floor(count))) {
    throw reader.error(line, "a whole number of records");
  }
  return static_cast<size_t>(count);
}

struct Columns {
  double metre = 1.0;  // the file's unit of length
  bool has_torque = false;
};

// The row of units: degrees degrees m^2 m^2 m^2 [m^2 m^3 m^3 m^3 …].
Columns read_columns(Reader& reader) {
  const Line titles = reader.require("a row of column titles");
  if (!titles.text.starts_with("Azimuth")) throw reader.error(titles, "titles from Azimuth on");
  const Line line = reader.require("a row of units");
  const std::vector<std::string_view> units = words_of(line.text);
  static const std::map<std::string, double> lengths_m = {
      {"m", 1.0}, {"mm", 1e-3}, {"cm", 1e-2}, {"in", 0.0254}, {"ft", 0.3048}};
  const std::string expected =
      "units degrees degrees, then forces in the square of m, mm, cm, in or ft";
  if (units.size() < 5 || units[0] != "degrees" || units[1] != "degrees") {
    throw reader.error(line, expected);
  }
  const std::string length(units[2].substr(0, units[2].find('^')));
  const auto known = lengths_m.find(length);
  const auto all_are = [&](size_t first, const std::string& unit) {
    return std::all_of(units.begin() + static_cast<std::ptrdiff_t>(first),
                       units.begin() + static_cast<std::ptrdiff_t>(first) + 3,
                       [&](std::string_view u) { return u == unit; });
  };
  if (known == lengths_m.end() || !all_are(2, length + "^2")) throw reader.error(line, expected);
  const bool has_torque = units.size() >= 9;
  if (has_torque && !all_are(6, length + "^3")) {
    throw reader.error(line, "torques in " + length + "^3 in columns 7 to 9");
  }
  return {known->second, has_torque};
}

struct Row {
  Line line;
  double azimuth_deg = 0.0, elevation_deg = 0.0;
  Vec3 force_N = Vec3::Zero(), torque_N_m = Vec3::Zero();
};

Row read_row(const Reader& reader, const Line& line, const Columns& columns) {
  const std::vector<std::string_view> words = words_of(line.text);
  const size_t needed = columns.has_torque ? 9 : 5;
  if (words.size() < needed) {
    throw reader.error(line, "at least " + std::to_string(needed) + " columns");
  }
  const double area = columns.metre * columns.metre;
  Row row{line, reader.number(line, words[0], "azimuth"),
          reader.number(line, words[1], "elevation")};
  for (size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    row.force_N[axis] = reader.number(line, words[2 + i], "force") * area;
    if (columns.has_torque) {
      row.torque_N_m[axis] = reader.number(line, words[6 + i], "torque") * area * columns.metre;
    }
  }
  return row;
}

}  // namespace

SpadFile parse_spad(const std::string& text, const std::string& name) {
  Reader reader(text, name);
  const Header header = read_header(reader);
  const size_t count = read_count(reader);
  const Columns columns = read_columns(reader);
  const Motion &azimuth = header.motions.at("Azimuth"), &elevation = header.motions.at("Elevation");

  const auto require_rows = [&](size_t rows, bool enough) {
    if (enough) return;
    throw InputError({name, 0}, "rows", std::to_string(rows),
                     std::to_string(azimuth.nodes() * elevation.nodes()) + " by the ranges and " +
                         std::to_string(count) + " by the record count");
  };
  // Before room is made for what the file cannot hold.
  require_rows(reader.left(), azimuth.nodes() * elevation.nodes() <= reader.left());
  SpadFile file{header.system,
                make_wrench_table(WrenchTable::Angles::azimuth_elevation, elevation.angles_rad(),
                                  azimuth.angles_rad(), header.centre_of_mass_m),
                columns.has_torque};
  std::vector<char> seen(file.table.nodes(), 0);
  size_t rows = 0;
  for (std::optional<Line> line = reader.next(); line; line = reader.next(), ++rows) {
    const Row row = read_row(reader, *line, columns);
    const auto around = azimuth.node_of(row.azimuth_deg);
    const auto polar = elevation.node_of(row.elevation_deg);
    if (!around || !polar) throw reader.error(row.line, "a direction on the grid of the header");
    const size_t node = file.table.node(*around, *polar);
    if (seen[node] != 0) throw reader.error(row.line, "every direction once");
    seen[node] = 1;
    file.table.force_body_N[node] = row.force_N;
    file.table.torque_body_N_m[node] = row.torque_N_m;
  }
  require_rows(rows, rows == count && rows == file.table.nodes());
  return file;
}

SpadFile read_spad(const std::filesystem::path& path) {
  return parse_spad(read_file(path), path.string());
}

}  // namespace photorque
