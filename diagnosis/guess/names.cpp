#include "diagnosis/guess/guess.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/recordings/aem.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/guess/file_head.h"
#include "diagnosis/guess/header.h"
#include "diagnosis/guess/meanings.h"
#include "photovoltaics/fit/curve_words.h"

namespace photorque {
namespace {

// Accepted units of a quantity, for messages.
std::string units_for(const std::string& dimension) {
  return dimension == "time"    ? "s, ms, µs, min or h"
         : dimension == "angle" ? "rad, mrad, deg (°), µrad, mdeg, arcmin, arcsec or rev (the "
                                  "counts of an encoder, divided by those of a turn)"
         : dimension == "angular rate"
             ? "rad/s, mrad/s, deg/s (°/s), mdeg/s, rpm (1/min, U/min, tr/min) or rev/s"
         : dimension == "length"       ? "m, cm or mm"
         : dimension == "speed"        ? "m/s, cm/s, mm/s, km/h or mph"
         : dimension == "acceleration" ? "m/s²"
                                       : "T, µT or nT";
}

std::string dimension_of(const Meaning& meaning) {
  return unit_of_key(meaning.stem + "_" + meaning.usual_unit).dimension;
}

// The suffix of a unit for a quantity; empty if none fits.
std::string fitting_unit(const HeaderCell& cell, const std::string& dimension, const Words& words) {
  const HeaderUnit& unit = *cell.unit;
  if (unit.dimension == dimension) return unit.suffix;
  if (dimension != "angular rate") return "";
  // In a name such as "omega_rads" the unit is rad/s.
  if (cell.unit_text.ends_with("rads") || cell.unit_text.ends_with("degs")) {
    return unit.suffix + "_s";
  }
  if (unit.dimension == "frequency") return unit.suffix;
  if (unit.dimension != "per second") return "";
  // 1/s means rad/s for an angular frequency ω, and rev/s for a rotational speed n.
  if (words.has_word_with_prefix({"omega", "w", "gyr", "angul", "winkel"}) ||
      words.any_has({"kreisfreq"})) {
    return "rad_s";
  }
  return words.any_has({"drehzahl", "umdreh", "drehfreq", "giri", "giros", "tours", "frequ"}) ||
                 words.any_is({"n"})
             ? "rev_s"
             : "";
}

// A cell of the header, with the unit that a line of units states below it.
HeaderCell cell_of(const FileHead& head, size_t place) {
  HeaderCell cell = read_header_cell(head.header[place]);
  if (cell.unit || head.units.empty()) return cell;
  cell.unit_text = head.units[place];
  cell.unit = unit_written(cell.unit_text);
  return cell;
}

// A column with its guess. If its name suggests a quantity of motion but its unit does not fit, the
// channel is empty and `wrong_unit` is that unit.
struct ReadColumn {
  GuessedColumn guess;
  std::string stem, dimension, wrong_unit;  // `wrong_unit`: set if the unit does not fit
  bool by_unit = false;
};

// A quantity whose unit is rad or rad/s is an angle or a rate, and one that rises in seconds is the
// time, whatever its name.
ReadColumn by_unit(const FileHead& head, size_t place, const HeaderCell& cell, const Words& words) {
  ReadColumn column{{head.header[place], ""}, "", "", "", true};
  if (!cell.unit || cell.unit->suffix.empty() || is_of_another_kind(words)) return column;
  const std::string& dimension = cell.unit->dimension;
  if (dimension == "time" && !cell.may_be_subscript && (cell.is_bare_unit || rises(head, place))) {
    column.stem = "t";
  } else if (dimension == "angle" && !cell.may_be_subscript) {
    column.stem = "angle";
  } else if (dimension == "angular rate") {
    column.stem = "rate";
  } else if (dimension == "length" && !cell.may_be_subscript) {
    column.stem = "x";
  } else {
    return column;
  }
  column.guess.channel = column.stem + "_" + cell.unit->suffix;
  column.guess.is_sure = cell.is_bare_unit;
  if (!cell.is_bare_unit) column.guess.because = "the unit alone says what is in";
  return column;
}

// The largest magnitude in the first rows of a column.
double largest_in(const FileHead& head, size_t column) {
  double largest = 0.0;
  for (const auto& row : head.rows) {
    if (std::isfinite(row[column])) largest = std::max(largest, std::abs(row[column]));
  }
  return largest;
}

// Unit of coordinates without a stated unit: metres, or millimetres if a value exceeds the size of
// any table.
std::string unit_of_coordinates(const FileHead& head, const std::vector<Words>& siblings,
                                size_t place) {
  constexpr double longest_m = 20.0;
  double most = 0.0;
  for (size_t k = 0; k < siblings.size(); ++k) {
    const bool is_coordinate = k == place || siblings[k].any_is({"x", "y"});
    if (is_coordinate) most = std::max(most, largest_in(head, k));
  }
  return most > longest_m ? "mm" : "m";
}

// Unit of an angle without a stated unit: degrees if it goes to and fro over more than a turn, as a
// swing or as an angle that starts again after a turn. An angle that only grows may be in radians.
std::string unit_of_angle(const FileHead& head, size_t place) {
  double least = 0.0, most = 0.0, forth = 0.0, back = 0.0;
  std::optional<double> last;
  for (const auto& row : head.rows) {
    const double angle = row[place];
    if (!std::isfinite(angle)) continue;
    if (last) (angle > *last ? forth : back) += std::abs(angle - *last);
    last = angle;
    least = std::min(least, angle);
    most = std::max(most, angle);
  }
  constexpr double to_and_fro = 0.1;
  const bool returns = std::min(forth, back) > to_and_fro * (forth + back);
  return returns && most - least > 2.0 * pi ? "deg" : "rad";
}

// Whether the last word belongs to an unknown unit per time: "rate_z_gon_s". The name means the
// same without it, and it is no axis or number.
bool is_part_of_unit(const Words& words, const std::string& axis, const HeaderCell& cell,
                     const std::vector<Meaning>& all) {
  if (all.empty() || words.all.size() < 2 || cell.unit->dimension != "time") return false;
  Words shorter = words;
  const std::string last = shorter.all.back();
  shorter.all.pop_back();
  const std::vector<Meaning> without = meanings(shorter, axis, cell);
  return last.size() > 1 && !without.empty() && without.front().stem == all.front().stem;
}

ReadColumn read_column(const FileHead& head, size_t place, HeaderCell cell,
                       const std::vector<Words>& siblings) {
  const std::string& in_file = head.header[place];
  const Words words = siblings[place];
  ReadColumn column{{in_file, ""}, "", "", ""};
  if (const std::string q = quaternion_of(words.all); !q.empty()) {
    column.guess.channel = q;
    return column;
  }
  const std::string axis = axis_of(words, siblings);
  const std::vector<Meaning> all = meanings(words, axis, cell);
  // Some names contain a unit: "rpm_left", "timeMs".
  if (!cell.unit && cell.unit_text.empty() && !all.empty()) {
    for (const std::string& word : words.all) {
      const auto unit = word.size() > 1 && word != "min" ? unit_written(word) : std::nullopt;
      if (unit && unit->dimension == dimension_of(all.front())) cell.unit = unit;
    }
  }
  const auto as = [&](const Meaning& meaning, const std::string& unit, bool is_stated) {
    column.stem = meaning.stem;
    column.guess.channel = meaning.stem + "_" + unit;
    column.guess.is_sure = is_stated && meaning.because.empty();
    column.guess.because = !is_stated ? "the header states no unit of" : meaning.because;
    return column;
  };
  const auto has_wrong_unit = [&](const Meaning& meaning) {
    column.stem = meaning.stem;
    column.dimension = dimension_of(meaning);
    column.wrong_unit = cell.unit_text;
    return column;
  };
  if (cell.unit) {
    for (const Meaning& meaning : all) {
      const std::string unit = fitting_unit(cell, dimension_of(meaning), words);
      if (!unit.empty()) return as(meaning, unit, true);
    }
    // If the stated unit contradicts the quantity (an angle in rad/s, a rate in 1/s), no unit can
    // be assumed.
    const auto is_of_turns = [](const std::string& dimension) {
      return dimension == "angle" || dimension == "angular rate" || dimension == "per second" ||
             dimension == "frequency";
    };
    for (const Meaning& meaning : all) {
      const std::string dimension = dimension_of(meaning);
      const bool contradicts = is_of_turns(dimension) && is_of_turns(cell.unit->dimension);
      if (cell.unit->dimension == dimension || contradicts) return has_wrong_unit(meaning);
    }
    if (is_part_of_unit(words, axis, cell, all)) {
      cell.unit_text = words.all.back() + "/" + cell.unit_text;
      return has_wrong_unit(all.front());
    }
    if (!cell.may_be_subscript) return by_unit(head, place, cell, words);
  } else if (!cell.unit_text.empty()) {
    return all.empty() ? column : has_wrong_unit(all.front());
  }
  if (all.empty()) return by_unit(head, place, cell, words);
  const Meaning& meaning = all.front();
  const std::string usual =
      meaning.stem == "t"                   ? (words.any_is({"millis"})   ? "ms"
                                               : words.any_is({"micros"}) ? "us"
                                                                          : clock_unit(head, place))
      : is_one_of(meaning.stem, {"x", "y"}) ? unit_of_coordinates(head, siblings, place)
      : meaning.usual_unit == "rad"         ? unit_of_angle(head, place)
                                            : meaning.usual_unit;
  return as(meaning, usual, false);
}

bool is_taken(const std::vector<ReadColumn>& columns, const std::string& stem) {
  return std::ranges::any_of(columns, [&](const ReadColumn& c) {
    return !c.guess.channel.empty() && unit_of_key(c.guess.channel).stem == stem;
  });
}

// Keeps the first named column of each channel. A column that is recognised by its unit alone is
// kept only if no other column has its channel.
void keep_first_of_each(std::vector<ReadColumn>& columns) {
  for (size_t i = 0; i < columns.size(); ++i) {
    std::string& channel = columns[i].guess.channel;
    if (channel.empty()) continue;
    const std::string stem = unit_of_key(channel).stem;
    bool other = false;
    for (size_t k = 0; k < columns.size(); ++k) {
      if (k == i || columns[k].guess.channel.empty()) continue;
      const bool same = unit_of_key(columns[k].guess.channel).stem == stem;
      other = other || (same && (columns[i].by_unit ? true : k < i && !columns[k].by_unit));
    }
    if (other && !columns[i].by_unit) channel.clear();
    if (other && columns[i].by_unit) columns[i].guess.shared = channel;
  }
  for (ReadColumn& column : columns) {
    if (!column.guess.shared.empty()) column.guess.channel.clear();
  }
}

bool is_motion(const std::string& channel) {
  return !channel.empty() && !begins(channel, {"t_", "frame", "accel_", "mag_"});
}

// If a wheel's speed is the only motion, it is taken as the rate of a machine that turns about one
// axis.
void read_lone_wheel(std::vector<ReadColumn>& columns) {
  ReadColumn* wheel = nullptr;
  for (ReadColumn& column : columns) {
    if (!is_motion(column.guess.channel)) continue;
    if (wheel != nullptr || !column.guess.channel.starts_with("wheel_")) return;
    wheel = &column;
  }
  if (wheel == nullptr) return;
  wheel->guess.channel = "rate_" + unit_of_key(wheel->guess.channel).unit;
  if (!wheel->guess.is_sure) return;
  wheel->guess.is_sure = false;
  wheel->guess.because = "no other motion is recorded, so the machine turns as the wheel of";
}

std::vector<ReadColumn> read_columns(const FileHead& head) {
  std::vector<HeaderCell> cells;
  std::vector<Words> words;
  for (size_t place = 0; place < head.header.size(); ++place) {
    cells.push_back(cell_of(head, place));
    words.push_back({cells.back().words});
  }
  // In physics s is a distance if another column is the time.
  const auto is_s = [](const HeaderCell& cell) {
    return cell.is_bare_unit && cell.unit_text == "s";
  };
  const bool has_time = std::ranges::any_of(words, [&](const Words& w) {
    const std::vector<Meaning> all = meanings(w, "", {});
    return !all.empty() && all.front().stem == "t";
  });
  for (size_t place = 0; has_time && place < cells.size(); ++place) {
    if (!is_s(cells[place])) continue;
    cells[place] = HeaderCell();
    words[place] = {{"s"}};
  }
  std::vector<ReadColumn> columns;
  for (size_t place = 0; place < cells.size(); ++place) {
    columns.push_back(read_column(head, place, cells[place], words));
  }
  const auto is_unsure = [](const ReadColumn& c, const char* stem) {
    return c.guess.channel.starts_with(stem) && !c.guess.is_sure && !c.by_unit;
  };
  // A velocity without a unit beside a coordinate is that of the coordinate.
  const bool has_place = std::ranges::any_of(columns, [](const ReadColumn& c) {
    return begins(c.guess.channel, {"x_", "y_"});
  });
  for (size_t k = 0; has_place && k < columns.size(); ++k) {
    if (is_unsure(columns[k], "rate_") &&
        words[k].has_word_with_prefix({"speed", "vel", "vitesse"})) {
      columns[k].guess.channel.clear();
    }
  }
  // The angles of a file have one unit.
  const bool has_degrees = std::ranges::any_of(columns, [&](const ReadColumn& c) {
    return is_unsure(c, "") && c.guess.channel.ends_with("_deg");
  });
  for (ReadColumn& c : columns) {
    if (has_degrees && is_unsure(c, "") && c.guess.channel.ends_with("_rad")) {
      c.guess.channel = c.stem + "_deg";
    }
  }
  keep_first_of_each(columns);
  read_lone_wheel(columns);
  return columns;
}

// The first column that counts frames or samples: its numbers are whole and rise.
void read_counter(const FileHead& head, std::vector<ReadColumn>& columns) {
  for (size_t k = 0; k < columns.size(); ++k) {
    const Words words{words_of_header(head.header[k])};
    const bool is_counter =
        words.has_word_with_prefix({"frame", "sampl", "index", "bild", "fotogram", "trame"}) ||
        words.any_is({"n", "nr", "no", "num", "image", "images"});
    const bool is_whole = std::ranges::all_of(
        head.rows, [k](const auto& row) { return row[k] == std::round(row[k]); });
    if (!is_counter || !is_whole || !rises(head, k) || !columns[k].guess.channel.empty()) continue;
    columns[k].guess.channel = "frame";
    return;
  }
}

// Large whole numbers of an encoder without a unit are counts.
void refuse_counts(const FileHead& head, const std::vector<ReadColumn>& columns,
                   const InputLocation& where) {
  constexpr double several_turns = 20.0;  // rad
  for (size_t k = 0; k < columns.size(); ++k) {
    const Words words{words_of_header(columns[k].guess.in_file)};
    const bool is_whole = std::ranges::all_of(head.rows, [k](const auto& row) {
      return std::isnan(row[k]) || row[k] == std::round(row[k]);
    });
    if (columns[k].stem == "angle" && !columns[k].guess.is_sure && is_whole &&
        largest_in(head, k) > several_turns && words.has_word_with_prefix({"encod", "count"})) {
      throw InputError(where, columns[k].guess.in_file, "whole numbers without a unit",
                       counts_of_encoder);
    }
  }
}

// The vector that a channel is a component of; empty for others.
std::string vector_of(const std::string& stem) {
  if (is_one_of(stem, {"x", "y"})) return "position";
  if (is_one_of(stem, {"roll", "pitch", "yaw"})) return "angles";
  const size_t end = stem.rfind('_');
  return end == std::string::npos || stem.size() != end + 2 ? "" : stem.substr(0, end);
}

// Whether a column in an unknown unit can be left out: a motion over time remains, and no other
// component of its vector.
bool is_dispensable(const ReadColumn& column, const std::vector<ReadColumn>& columns,
                    bool has_clock) {
  if (column.stem == "t" || unit_written(column.wrong_unit)) return false;
  const std::string vector = vector_of(column.stem);
  bool moves = false;
  for (const ReadColumn& c : columns) {
    if (!is_motion(c.guess.channel)) continue;
    moves = true;
    if (!vector.empty() && vector_of(unit_of_key(c.guess.channel).stem) == vector) return false;
  }
  return moves && has_clock;
}

// The channel of a column whose unit is not suitable, in the unit that it may have.
std::string channel_in_SI(const ReadColumn& column) {
  const std::string unit = column.dimension == "time"           ? "s"
                           : column.dimension == "angle"        ? "rad"
                           : column.dimension == "angular rate" ? "rad_s"
                           : column.dimension == "length"       ? "m"
                           : column.dimension == "speed"        ? "m_s"
                                                                : "";
  return unit.empty() ? "" : column.stem + "_" + unit;
}

// A reading in an unknown unit would be of a wrong size. It is left out if other motion remains.
void refuse_wrong_units(std::vector<ReadColumn>& columns, const std::filesystem::path& path,
                        const FileHead& head, const RecordingOptions& reading) {
  const bool turns = std::ranges::any_of(columns, [](const ReadColumn& c) {
    return is_motion(c.guess.channel) && !begins(c.guess.channel, {"x_", "y_"});
  });
  const bool has_clock = reading.rate_Hz || is_taken(columns, "t");
  for (ReadColumn& c : columns) {
    if (c.wrong_unit.empty() || is_taken(columns, c.stem)) continue;
    if (begins(c.stem, {"accel_", "mag_"}) || (turns && is_one_of(c.stem, {"x", "y"}))) continue;
    if (is_dispensable(c, columns, has_clock)) {
      c.guess.unknown_unit = c.wrong_unit;
      continue;
    }
    std::vector<GuessedColumn> offered;
    for (const ReadColumn& one : columns) {
      offered.push_back(one.guess);
      if (&one == &c) offered.back().channel = channel_in_SI(c);
    }
    const std::string command = command_for_columns(path, reading, offered);
    throw InputError({path.string(), head.line}, c.guess.in_file,
                     "the unit " + in_quotes(c.wrong_unit),
                     units_for(c.dimension) +
                         ": convert the column, or rename it if it is another "
                         "quantity" +
                         (command.empty() ? "" : "; or " + command));
  }
}

// The last column of a voltage or a current by its name, also in an unknown unit; no dark curve.
std::optional<size_t> place_of(curve_text::Column wanted,
                               const std::vector<GuessedColumn>& columns) {
  const bool is_voltage = wanted == curve_text::voltage;
  std::optional<size_t> place;
  for (size_t k = 0; k < columns.size(); ++k) {
    const std::string& name = columns[k].in_file;
    const Words words{words_of_header(name)};
    const curve_text::Column column = curve_text::named(name).column;
    const bool is_named = column != curve_text::columns ? column == wanted
                          : is_voltage                  ? words.any_is({"v", "u"})
                                                        : words.any_is({"i", "j"});
    if (is_named && !words.any_is({"d", "dark"})) place = k;
  }
  return place;
}

}  // namespace

std::vector<GuessedColumn> guess_columns(const std::filesystem::path& path,
                                         const RecordingOptions& reading) {
  if (is_aem(path)) return {{"q_w", "q_w"}, {"q_x", "q_x"}, {"q_y", "q_y"}, {"q_z", "q_z"}};
  const FileHead head = head_of(path, reading);
  std::vector<ReadColumn> columns = read_columns(head);
  if (!is_taken(columns, "t")) read_counter(head, columns);
  refuse_wrong_units(columns, path, head, reading);
  refuse_counts(head, columns, {path.string(), head.line});
  std::vector<GuessedColumn> all;
  for (const ReadColumn& column : columns) all.push_back(column.guess);
  return all;
}

bool has_motion(const std::vector<GuessedColumn>& columns) {
  return std::ranges::any_of(columns, [](const GuessedColumn& c) { return is_motion(c.channel); });
}

bool has_time(const std::vector<GuessedColumn>& columns) {
  return std::ranges::any_of(columns,
                             [](const GuessedColumn& c) { return c.channel.starts_with("t_"); });
}

std::string command_for_columns(const std::filesystem::path& path, const RecordingOptions& reading,
                                const std::vector<GuessedColumn>& columns) {
  const FileHead head = head_of(path, reading);
  std::vector<std::string> names;
  for (size_t k = 0; k < columns.size(); ++k) {
    names.push_back(columns[k].channel.empty() ? "column_" + std::to_string(k + 1)
                                               : columns[k].channel);
  }
  const auto voltage = place_of(curve_text::voltage, columns),
             current = place_of(curve_text::current, columns);
  if (!has_motion(columns)) {
    if (!voltage || !current || voltage == current) return "";
    names[*voltage] = "voltage_V";
    names[*current] = "current_A";
  } else if (!has_time(columns) && !reading.rate_Hz) {
    size_t k = 0;
    while (k < names.size() && !(columns[k].channel.empty() && rises(head, k))) ++k;
    if (k == names.size()) return "";
    names[k] = "t_" + clock_unit(head, k);
  }
  return command_with_names(path, joined_text(names, ","));
}

std::string names_in(const std::filesystem::path& path, const RecordingOptions& reading) {
  return joined_text(head_of(path, reading).header, ", ",
                     [&](const std::string& name) { return in_quotes(name); });
}

}  // namespace photorque
