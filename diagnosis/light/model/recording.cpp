#include "diagnosis/light/model/recording.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <unordered_set>

#include "attitude/recordings/text_lines.h"
#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/numerics/random.h"
#include "core/numerics/series.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "core/transform.h"
#include "photovoltaics/fit/curve_text.h"

namespace photorque {
namespace {

constexpr double absent = std::numeric_limits<double>::quiet_NaN();

// Index of a column in a row, and its conversion to SI.
struct LightColumn {
  size_t place = 0;
  double to_SI = 1.0;
};

// The columns that identify a kind of recording, the most characteristic one last.
struct ColumnsOfKind {
  LightRecording::Kind kind;
  std::vector<std::string> needed;
};

std::vector<ColumnsOfKind> columns_of_kinds() {
  using Kind = LightRecording::Kind;
  return {{Kind::scan, {"u_m", "v_m", "irradiance_W_m2"}},
          {Kind::run, {"t_s", "q_w", "array_voltage_V", "array_current_A"}},
          {Kind::sweep, {"voltage_V", "current_A"}}};
}

class LightHeader {
 public:
  LightHeader(std::string_view line, const std::map<std::string, std::string>& columns)
      : separator_(separator_of(line)) {
    for (std::string_view cell : cells_of(line, separator_)) {
      written_.emplace_back(cell);
      cell = name_of_column(cell, columns);
      // Names used by some instruments.
      if (cell == "V") cell = "voltage_V";
      if (cell == "I") cell = "current_A";
      const KeyUnit unit = unit_of_key(cell);
      names_.emplace_back(cell);
      units_.push_back(unit);
    }
    for (const auto& [name, written] : columns) ignore_beside(name, written);
  }
  char separator() const { return separator_; }
  size_t columns() const { return names_.size(); }
  const std::vector<std::string>& names() const { return names_; }
  // The header cells as written.
  const std::vector<std::string>& written() const { return written_; }

  // Finds a column by its name in SI, or in another unit of the quantity.
  std::optional<LightColumn> find(const std::string& name) const {
    const KeyUnit wanted = unit_of_key(name);
    for (size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] == name) return LightColumn{i, wanted.to_SI};
    }
    for (size_t i = 0; i < names_.size(); ++i) {
      if (is_of(i, wanted)) return LightColumn{i, units_[i].to_SI};
    }
    return std::nullopt;
  }
  // The columns that a kind needs and this header lacks.
  std::vector<std::string> missing_for(const ColumnsOfKind& kind) const {
    std::vector<std::string> missing = kind.needed;
    std::erase_if(missing, [&](const std::string& name) { return find(name).has_value(); });
    return missing;
  }
  std::optional<LightRecording::Kind> kind() const {
    for (const ColumnsOfKind& kind : columns_of_kinds()) {
      if (missing_for(kind).empty()) return kind.kind;
    }
    return std::nullopt;
  }
  // The missing columns of a kind whose most characteristic one is present.
  std::vector<std::string> missing() const {
    for (const ColumnsOfKind& kind : columns_of_kinds()) {
      if (find(kind.needed.back())) return missing_for(kind);
    }
    return {};
  }

 private:
  // Whether a column has the quantity of this key, also in another unit.
  bool is_of(size_t column, const KeyUnit& wanted) const {
    return !wanted.unit.empty() && units_[column].stem == wanted.stem &&
           units_[column].dimension == wanted.dimension;
  }

  // If the file has the column `written` for the quantity `name`, other columns of that quantity
  // are ignored.
  void ignore_beside(const std::string& name, const std::string& written) {
    if (std::ranges::find(written_, written) == written_.end()) return;
    const KeyUnit wanted = unit_of_key(name);
    for (size_t i = 0; i < names_.size(); ++i) {
      if ((names_[i] != name && !is_of(i, wanted)) || written_[i] == written) continue;
      names_[i].clear();
      units_[i] = {};
    }
  }

  char separator_;
  std::vector<std::string> names_, written_;
  std::vector<KeyUnit> units_;
};

// The first line that is neither blank nor a comment.
bool next_line(TextLines& lines, std::string_view& line) {
  while (lines.next(line)) {
    line = trimmed(line.substr(0, line.find('#')));
    if (!line.empty()) return true;
  }
  return false;
}

// The beginning of a file: a header of this reader, or the cells of one of curves in an instrument
// format.
struct Beginning {
  std::optional<LightHeader> header;
  std::vector<std::string> cells;    // header cells as written
  std::vector<std::string> missing;  // without a header: columns that the nearest line lacks

  bool is_curve() const { return !header && !cells.empty(); }
};

// Preambles may lack comment marks: the header is the first line that identifies a kind of
// recording.
Beginning find_header(TextLines& lines, const std::map<std::string, std::string>& columns) {
  constexpr int most = 200;
  const bool has_attitude = std::ranges::any_of(columns, [](const auto& column) {
    return column.first.starts_with("tilt") || column.first.starts_with("heading") ||
           column.first.starts_with("q_");
  });
  std::string_view line;
  Beginning unknown;
  for (int i = 0; i < most && next_line(lines, line); ++i) {
    const LightHeader header(line, columns);
    const auto kind = header.kind();
    // Only the reader of curves knows the conditions in the comments of instruments and foreign
    // names of irradiance and temperature, but it knows no attitude.
    const bool may_be_curve =
        !kind || (*kind == LightRecording::Kind::sweep &&
                  (header.separator() != ',' || (!has_attitude && !LightHeader(line, {}).kind())));
    if (may_be_curve && is_curve_header(line, columns)) return {{}, curve_header_cells(line), {}};
    if (kind) return {header, header.written(), {}};
    if (unknown.missing.empty()) unknown.missing = header.missing();
  }
  return unknown;
}

// Reads one row; each function returns the reason for a rejection, or an empty string.
class RowReader {
 public:
  RowReader(const LightHeader& header, const DefaultConditions& usual, LightRecording& into)
      : header_(header), usual_(usual), into_(into) {}

  bool has_lamps() const { return lamps_.has_value(); }
  bool has_temperature() const { return temperature_.has_value(); }
  bool has_curve_numbers() const { return sweep_.has_value(); }
  bool has_quaternion() const { return q_w_ && q_x_ && q_y_ && q_z_; }
  bool has_angles() const { return tilt_ && heading_; }

  std::string add(const std::vector<std::string_view>& cells) {
    cells_ = &cells;
    if (!is_run_ && !is_new()) return "repeated row";
    const auto attitude = attitude_of_row();
    if (!attitude) return "unreadable attitude";
    const double temperature_K = temperature_ ? value(temperature_) : usual_.temperature_K;
    if (into_.kind != LightRecording::Kind::scan && !(temperature_K > 0.0)) {
      return "unreadable temperature";
    }
    if (into_.kind == LightRecording::Kind::scan) {
      const double u_m = value(u_), v_m = value(v_), E = value(irradiance_);
      if (!std::isfinite(u_m + v_m + E)) return "unreadable number";
      into_.u_m.push_back(u_m);
      into_.v_m.push_back(v_m);
      into_.irradiance_W_m2.push_back(E);
    } else {
      const double V = value(voltage_), I = value(current_);
      if (!std::isfinite(V) || !std::isfinite(I)) return "unreadable number";
      if (is_run_) {
        const double time_s = value(time_);
        if (!std::isfinite(time_s)) return "row without time";
        if (!into_.time_s.empty() && time_s == into_.time_s.back()) return "repeated time";
        into_.time_s.push_back(time_s);
        // An empty cell keeps the previous value.
        const double lamp_A = value(lamps_);
        const double before = into_.lamp_light.empty() ? 1.0 : into_.lamp_light.back();
        into_.lamp_light.push_back(std::isfinite(lamp_A) ? std::max(0.0, lamp_A) : before);
      } else {
        const double number = sweep_ ? value(sweep_) : 0.0;
        constexpr double most = 1e9;  // fits an int, and exceeds any measurement
        if (!(std::abs(number) <= most)) return "unreadable number";
        into_.sweep.push_back(static_cast<int>(number));
        if (irradiance_) into_.irradiance_W_m2.push_back(value(irradiance_));
      }
      into_.voltage_V.push_back(V);
      into_.current_A.push_back(I);
    }
    into_.temperature_K.push_back(temperature_K);
    into_.lab_from_body.push_back(*attitude);
    return "";
  }

 private:
  // In readings with noise, a second row with identical digits is a copy.
  bool is_new() {
    uint64_t hash = 0;
    for (const std::string_view cell : *cells_) {
      hash = hash_words(hash, std::hash<std::string_view>()(cell), 0, 0);
    }
    return seen_.insert(hash).second;
  }

  using Column = std::optional<LightColumn>;

  double value(const Column& column) const {
    if (!column || column->place >= cells_->size()) return absent;
    const auto number = number_of_cell((*cells_)[column->place], header_.separator());
    return number ? *number * column->to_SI : absent;
  }

  std::optional<Quat> attitude_of_row() const {
    if (has_quaternion()) {
      const Quat q(value(q_w_), value(q_x_), value(q_y_), value(q_z_));
      constexpr double off = 0.01;  // relative deviation from norm 1
      if (!(std::abs(q.norm() - 1.0) < off)) return std::nullopt;
      return q.normalized();
    }
    if (!has_angles()) return usual_.lab_from_body;
    const double tilt_rad = value(tilt_), heading_rad = value(heading_);
    if (!std::isfinite(tilt_rad) || !std::isfinite(heading_rad)) return std::nullopt;
    return lab_from_body_at(tilt_rad, heading_rad).rotation;
  }

  const LightHeader& header_;
  const DefaultConditions& usual_;
  LightRecording& into_;
  const bool is_run_ = into_.kind == LightRecording::Kind::run;
  const Column u_ = header_.find("u_m"), v_ = header_.find("v_m"),
               irradiance_ = header_.find("irradiance_W_m2"),
               voltage_ = header_.find(is_run_ ? "array_voltage_V" : "voltage_V"),
               current_ = header_.find(is_run_ ? "array_current_A" : "current_A"),
               time_ = header_.find("t_s"), q_w_ = header_.find("q_w"), q_x_ = header_.find("q_x"),
               q_y_ = header_.find("q_y"), q_z_ = header_.find("q_z"),
               tilt_ = header_.find("tilt_deg"), heading_ = header_.find("heading_deg"),
               temperature_ = header_.find("cell_temperature_K"), sweep_ = header_.find("sweep"),
               lamps_ = is_run_ ? header_.find("led_current_A") : std::nullopt;
  const std::vector<std::string_view>* cells_ = nullptr;
  std::unordered_set<uint64_t> seen_;
};

// Rejects an incomplete or misnamed attitude, which would silently be replaced by that of the
// experiment.
void require_whole_attitude(const LightHeader& header, const RowReader& reader,
                            const std::filesystem::path& path) {
  if (reader.has_quaternion() || reader.has_angles()) return;
  for (const std::string& name : header.names()) {
    const bool is_attitude =
        name.starts_with("tilt") || name.starts_with("heading") || name.starts_with("q_");
    if (!is_attitude) continue;
    throw InputError({path.string()}, "header", "the column " + name + " alone of an attitude",
                     "tilt_deg and heading_deg, or q_w, q_x, q_y and q_z");
  }
}

// Replaces steady segments of the lamp current by their means: its noise does not affect the light.
void smooth_steady(std::vector<double>& lamps) {
  if (lamps.size() < 3) return;
  std::vector<double> steps;
  for (size_t i = 1; i < lamps.size(); ++i) steps.push_back(std::abs(lamps[i] - lamps[i - 1]));
  const auto middle = steps.begin() + static_cast<ptrdiff_t>((steps.size() - 1) / 2);
  std::ranges::nth_element(steps, middle);
  // The median of |difference of two readings| is 0.954 of their noise.
  constexpr double median_of_noise = 0.954, beyond = 5.0, least_change = 0.01;
  hold_means(lamps,
             std::min(beyond * *middle / median_of_noise, least_change * std::ranges::max(lamps)));
}

// Lamp currents relative to the largest; cleared if they hardly vary, which is noise of a constant
// current.
void make_relative(std::vector<double>& lamps) {
  constexpr double changes = 0.05;
  if (lamps.empty()) return;
  const auto [low, high] = std::ranges::minmax(lamps);
  if (!(high > 0.0) || high - low < changes * high) {
    lamps.clear();
    return;
  }
  smooth_steady(lamps);
  const double brightest = std::ranges::max(lamps);
  for (double& current : lamps) current /= brightest;
}

// The named columns that a header lacks.
std::set<std::string> absent_of(const std::map<std::string, std::string>& named,
                                const std::vector<std::string>& cells) {
  std::set<std::string> absent_columns;
  for (const auto& [name, written] : named) {
    if (std::ranges::find(cells, written) == cells.end()) absent_columns.insert(written);
  }
  return absent_columns;
}

// Reads curves in instrument formats.
LightRecording curves_of_instrument(const std::filesystem::path& path,
                                    const DefaultConditions& usual,
                                    const RecordingOptions& options) {
  const std::string text = whole_text(path, options.header);
  const std::vector<MeasuredCurve> curves = curves_in(text, path.string(), options.columns);
  LightRecording all;
  all.kind = LightRecording::Kind::sweep;
  all.name = path.string();
  all.has_attitudes = false;
  int64_t unread = 0;
  const bool has_light = std::ranges::any_of(
      curves, [](const MeasuredCurve& c) { return c.irradiance_W_m2.has_value(); });
  for (size_t k = 0; k < curves.size(); ++k) {
    const MeasuredCurve& curve = curves[k];
    const size_t rows = curve.sweep.voltage_V.size();
    const auto append = [rows](auto& to, const auto& value) { to.insert(to.end(), rows, value); };
    std::ranges::copy(curve.sweep.voltage_V, std::back_inserter(all.voltage_V));
    std::ranges::copy(curve.sweep.current_A, std::back_inserter(all.current_A));
    append(all.sweep, static_cast<int>(k));
    append(all.lab_from_body, usual.lab_from_body);
    append(all.temperature_K, curve.temperature_K.value_or(usual.temperature_K));
    if (has_light) append(all.irradiance_W_m2, curve.irradiance_W_m2.value_or(absent));
    all.is_reversed = all.is_reversed || curve.is_reversed;
    all.is_stacked = all.is_stacked || curve.is_stacked;
    all.is_density = all.is_density || curve.is_density;
    all.has_temperatures = all.has_temperatures && curve.temperature_K.has_value();
    unread += static_cast<int64_t>(curve.unread);
  }
  if (unread > 0) all.rejected["unreadable number"] = unread;
  all.rows_read = static_cast<int64_t>(all.rows()) + unread;
  if (all.rows() == 0) {
    throw InputError({path.string()}, "rows", "no usable row", "at least one row of numbers");
  }
  return all;
}

// The rows of each curve, in order of their first rows.
std::vector<std::vector<size_t>> rows_of_sweeps(const LightRecording& recording) {
  std::map<int, size_t> places;
  std::vector<std::vector<size_t>> rows;
  for (size_t i = 0; i < recording.rows(); ++i) {
    const auto [place, is_new] = places.try_emplace(recording.sweep[i], rows.size());
    if (is_new) rows.emplace_back();
    rows[place->second].push_back(i);
  }
  return rows;
}

// Numbers the curves of a file that states no numbers.
void number_curves(LightRecording& recording) {
  const std::vector<size_t> starts = starts_of_curves(recording.voltage_V);
  for (size_t k = 1; k < starts.size(); ++k) {
    const auto from = recording.sweep.begin() + static_cast<ptrdiff_t>(starts[k]);
    std::fill(from, recording.sweep.end(), static_cast<int>(k));
  }
  recording.is_stacked = starts.size() > 1;
}

// Reverses and cleans each curve.
LightRecording with_clean_curves(LightRecording recording) {
  std::vector<size_t> kept;
  const auto count = [&](const std::string& reason, size_t readings) {
    if (readings > 0) recording.rejected[reason] += static_cast<int64_t>(readings);
  };
  for (const std::vector<size_t>& rows : rows_of_sweeps(recording)) {
    IvSweep sweep;
    for (const size_t i : rows) {
      sweep.voltage_V.push_back(recording.voltage_V[i]);
      sweep.current_A.push_back(recording.current_A[i]);
    }
    if (reverse_negative(sweep)) {
      recording.is_reversed = true;
      for (const size_t i : rows) recording.current_A[i] = -recording.current_A[i];
    }
    const CurveCleaning cleaning = clean_curve(sweep, true);
    for (const size_t k : cleaning.kept) kept.push_back(rows[k]);
    count("outlier", cleaning.spikes);
    count("no current where others flow", cleaning.dead);
    count("beyond open circuit", cleaning.clipped);
  }
  if (kept.size() == recording.rows()) return recording;
  std::ranges::sort(kept);
  return recording.part(kept);
}

}  // namespace

LightRecording LightRecording::part(const std::vector<size_t>& rows) const {
  const auto keep = [&](auto& column) {
    if (column.empty()) return;
    std::decay_t<decltype(column)> some;
    some.reserve(rows.size());
    for (const size_t row : rows) some.push_back(column[row]);
    column = std::move(some);
  };
  LightRecording some = *this;
  for (auto* column : {&some.u_m, &some.v_m, &some.irradiance_W_m2, &some.voltage_V,
                       &some.current_A, &some.time_s, &some.temperature_K, &some.lamp_light}) {
    keep(*column);
  }
  keep(some.lab_from_body);
  keep(some.sweep);
  return some;
}

std::vector<LightRecording> sweeps_of(const LightRecording& recording) {
  const std::vector<std::vector<size_t>> all = rows_of_sweeps(recording);
  std::vector<LightRecording> curves;
  for (const std::vector<size_t>& rows : all) {
    curves.push_back(all.size() > 1 ? recording.part(rows) : recording);
    if (all.size() == 1) break;
    curves.back().name += ", sweep " + std::to_string(recording.sweep[rows.front()]);
    curves.back().rows_read = static_cast<int64_t>(rows.size());
    curves.back().rejected.clear();
  }
  // Counts rejected rows of the file only once.
  for (const auto& [reason, count] : recording.rejected) {
    if (curves.size() > 1) curves.front().rows_read += count;
  }
  if (!curves.empty()) curves.front().rejected = recording.rejected;
  return curves;
}

double median_of(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  return values.empty() ? absent : upper_median(std::move(values));
}

std::optional<LightRecording::Kind> light_kind_of(const std::filesystem::path& path,
                                                  const RecordingOptions& options) {
  try {
    TextLines lines(path, options.header);
    const Beginning beginning = find_header(lines, options.columns);
    if (beginning.is_curve()) return LightRecording::Kind::sweep;
    return beginning.header ? beginning.header->kind() : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

bool is_light_recording(const std::filesystem::path& path, const RecordingOptions& options) {
  return light_kind_of(path, options).has_value();
}

std::vector<std::string> reading_notes(const std::vector<LightRecording>& recordings) {
  std::vector<std::string> notes;
  for (const LightRecording& recording : recordings) {
    const std::string name = std::filesystem::path(recording.name).filename().string();
    if (recording.is_reversed) {
      notes.push_back(name + ": currents are negative in light; their sign was reversed");
    }
    if (recording.is_stacked) {
      notes.push_back(name + ": the voltage returns in one step; read as " +
                      std::to_string(rows_of_sweeps(recording).size()) +
                      " curves, one below the other");
    }
  }
  return notes;
}

LightRecording read_light_recording(const std::filesystem::path& path,
                                    const DefaultConditions& usual,
                                    const RecordingOptions& options) {
  TextLines lines(path, options.header);
  const Beginning beginning = find_header(lines, options.columns);
  if (beginning.is_curve()) {
    LightRecording curves = curves_of_instrument(path, usual, options);
    curves.absent_columns = absent_of(options.columns, beginning.cells);
    return with_clean_curves(std::move(curves));
  }
  const std::optional<LightHeader>& header = beginning.header;
  if (!header) {
    const std::string missing = joined_text(beginning.missing, ", ");
    throw InputError({path.string()}, "header",
                     missing.empty() ? "no line with the columns of a recording"
                                     : "no column " + missing + " beside the others",
                     "u_m,v_m,irradiance_W_m2 (a scan), voltage_V,current_A (a sweep) or "
                     "t_s,q_w,q_x,q_y,q_z,array_voltage_V,array_current_A (a run); other names by "
                     "[recording] columns = { voltage_V = \"NAME\", current_A = \"NAME\" }");
  }
  LightRecording recording;
  recording.kind = *header->kind();
  recording.name = path.string();
  RowReader reader(*header, usual, recording);
  recording.absent_columns = absent_of(options.columns, beginning.cells);
  require_whole_attitude(*header, reader, path);
  recording.has_temperatures = reader.has_temperature();
  recording.has_attitudes = reader.has_quaternion() || reader.has_angles();
  std::string_view line;
  std::vector<std::string_view> cells;
  const std::string wrong_length = "wrong number of cells";
  int64_t of_wrong_length = 0;
  int first_of_wrong_length = 0;
  size_t cells_there = 0;
  while (next_line(lines, line)) {
    ++recording.rows_read;
    split_cells(line, header->separator(), cells);
    const std::string reason = cells.size() == header->columns() ? reader.add(cells) : wrong_length;
    if (reason == wrong_length && ++of_wrong_length == 1) {
      first_of_wrong_length = static_cast<int>(lines.number());
      cells_there = cells.size();
    }
    if (!reason.empty()) ++recording.rejected[reason];
  }
  // A few incomplete rows are omitted. If most rows are incomplete, the file has another fault,
  // such as decimal commas.
  if (2 * of_wrong_length > recording.rows_read) {
    throw wrong_row({path.string(), first_of_wrong_length}, cells_there, header->columns());
  }
  if (recording.rows() == 0) {
    throw InputError({path.string(), static_cast<int>(lines.number())}, "rows", "no usable row",
                     "at least one row of numbers");
  }
  if (reader.has_lamps() && !(std::ranges::max(recording.lamp_light) > 0.0)) {
    throw InputError({path.string()}, "led_current_A", "no current in any row",
                     "a lamp current above 0, or no such column");
  }
  make_relative(recording.lamp_light);
  if (recording.kind == LightRecording::Kind::sweep) {
    if (!reader.has_curve_numbers()) number_curves(recording);
    return with_clean_curves(std::move(recording));
  }
  return recording;
}

}  // namespace photorque
