// EULUMDAT: A. Stockmar, "EULUMDAT – ein Leuchtendatenformat für den europäischen
// Beleuchtungsplaner", Licht 90 (1990). One value per line.
#include <algorithm>
#include <cmath>

#include "core/text/parse.h"
#include "sources/photometry/file.h"

namespace photorque {
namespace {

class ValueLines {
 public:
  ValueLines(const std::string& bytes, const std::string& name)
      : lines_(lines_of(bytes)), name_(name) {}

  InputLocation where() const { return {name_, static_cast<int>(std::max<size_t>(next_, 1))}; }

  std::string text(const char* what) {
    if (next_ >= lines_.size()) {
      throw InputError({name_, static_cast<int>(lines_.size())}, what, "the end of the file",
                       "one more line");
    }
    return std::string(trimmed(lines_[next_++]));
  }

  // A number with a decimal comma or point.
  double number(const char* what) {
    std::string line = text(what);
    const std::string found = line;
    std::replace(line.begin(), line.end(), ',', '.');
    if (const auto value = number_in(line)) return *value;
    throw InputError(where(), what, in_quotes(found), "a number");
  }

  // An unimportant number; an empty line counts as zero.
  double number_or_zero(const char* what) {
    if (next_ < lines_.size() && trimmed(lines_[next_]).empty()) {
      ++next_;
      return 0.0;
    }
    return number(what);
  }

  size_t count(const char* what, int low, int high) {
    const double value = number(what);
    return require_count(value, where(), what, low, high);
  }

  std::vector<double> numbers(const char* what, size_t count) {
    std::vector<double> values;
    for (size_t i = 0; i < count; ++i) values.push_back(number(what));
    return values;
  }

 private:
  std::vector<std::string_view> lines_;
  const std::string& name_;
  size_t next_ = 0;
};

struct Lamps {
  double flux_lm = 0.0;
  double input_power_W = 0.0;
  bool absolute = false;
};

Lamps read_lamps(ValueLines& lines) {
  Lamps lamps;
  const size_t sets = lines.count("number of lamp sets", 0, 20);
  for (size_t i = 0; i < sets; ++i) {
    lamps.absolute = lines.number_or_zero("number of lamps") < 0.0 || lamps.absolute;
    lines.text("type of lamps");
    lamps.flux_lm += lines.number_or_zero("luminous flux of lamps");
    lines.text("colour temperature");
    lines.text("colour rendering");
    lamps.input_power_W += lines.number_or_zero("power of lamps");
  }
  return lamps;
}

// The C planes that a file of this symmetry stores: the first one and their number.
struct StoredRange {
  size_t first = 0, count = 1;
  PlaneSymmetry symmetry = PlaneSymmetry::none;
};

StoredRange stored_range(size_t symmetry, size_t planes) {
  switch (symmetry) {
    case 2:
      return {0, planes / 2 + 1, PlaneSymmetry::across_0_180};
    case 3:
      return {3 * planes / 4, planes / 2 + 1, PlaneSymmetry::across_90_270};
    case 4:
      return {0, planes / 4 + 1, PlaneSymmetry::both};
    case 1:
      return {0, 1, PlaneSymmetry::none};
    default:
      return {0, planes, PlaneSymmetry::none};
  }
}

Opening read_opening(ValueLines& lines) {
  constexpr double mm = 1e-3;
  for (const char* what :
       {"length of the luminaire", "width of the luminaire", "height of the luminaire"}) {
    lines.number_or_zero(what);
  }
  Opening opening;
  opening.y_m = mm * std::abs(lines.number_or_zero("length of the luminous area"));
  opening.x_m = mm * std::abs(lines.number_or_zero("width of the luminous area"));
  if (opening.y_m == 0.0 && opening.x_m == 0.0) return opening;
  opening.shape = opening.x_m == 0.0 ? Opening::Shape::ellipse : Opening::Shape::rectangle;
  if (opening.x_m == 0.0) opening.x_m = opening.y_m;
  return opening;
}

// Reads the `planes` stored in the file with their `angles`; intensities are multiplied by
// `factor`.
StoredPlanes read_planes(ValueLines& lines, const StoredRange& range, size_t planes, size_t angles,
                         double factor) {
  const std::vector<double> all_c_deg = lines.numbers("C angle", planes);
  StoredPlanes stored;
  for (size_t j = 0; j < range.count; ++j) {
    stored.azimuth_deg.push_back(all_c_deg[(range.first + j) % planes]);
  }
  stored.polar_deg = lines.numbers("gamma angle", angles);
  require_ascending(stored.polar_deg, "gamma angles", lines.where());
  require_goniometer_range(stored.polar_deg, lines.where());
  for (size_t i = 0; i < range.count * angles; ++i) {
    stored.intensity.push_back(factor * lines.number("intensity"));
    if (!std::isfinite(stored.intensity.back())) {
      throw InputError(lines.where(), "intensity", "a number that overflows", "a finite one");
    }
  }
  return stored;
}

}  // namespace

PhotometricFile read_eulumdat(const std::string& bytes, const std::string& name) {
  ValueLines lines(bytes, name);
  PhotometricFile file;
  file.format = "EULUMDAT";
  file.labels.emplace_back("MANUFAC", lines.text("company"));
  lines.count("type indicator", 0, 3);
  const size_t symmetry = lines.count("symmetry indicator", 0, 4);
  const size_t planes = lines.count("number of C planes", 1, 721);
  lines.number_or_zero("distance between C planes");
  const size_t angles = lines.count("number of intensities in a plane", 2, 7201);
  lines.number_or_zero("distance between intensities");
  for (const char* keyword : {"TEST", "LUMINAIRE", "LUMCAT", "FILE", "DATE"}) {
    file.labels.emplace_back(keyword, lines.text(keyword));
  }
  file.opening = read_opening(lines);
  require_opening(file.opening, lines.where());
  for (int i = 0; i < 4; ++i) lines.number_or_zero("height of the luminous area");
  lines.number_or_zero("downward flux fraction");
  lines.number_or_zero("light output ratio");
  const double conversion = lines.number("conversion factor");
  const double tilt_deg = lines.number_or_zero("tilt during measurement");
  if (tilt_deg != 0.0) {
    file.notices.push_back("measured at a tilt of " + shortest(tilt_deg) +
                           " deg, by which the lamp is not turned");
  }
  const Lamps lamps = read_lamps(lines);
  for (int i = 0; i < 10; ++i) lines.number_or_zero("direct ratio");
  file.input_power_W = lamps.input_power_W;
  if (!lamps.absolute && lamps.flux_lm > 0.0) file.stated_flux_lm = lamps.flux_lm;
  // A file without lamps still defines the shape.
  const double factor = conversion * (lamps.flux_lm > 0.0 ? lamps.flux_lm / 1000.0 : 1.0);
  if (!(factor > 0.0)) {
    throw InputError(lines.where(), "conversion factor", shortest(conversion), "a number > 0");
  }

  const StoredRange range = stored_range(symmetry, planes);
  // With these symmetries the stored half or quarter of the planes must end on a plane.
  const size_t parts = symmetry == 2 ? 2 : 4;
  if (symmetry > 1 && planes % parts != 0) {
    throw InputError(lines.where(), "number of C planes", std::to_string(planes),
                     "a multiple of " + std::to_string(parts) + " for this symmetry");
  }
  const StoredPlanes stored = read_planes(lines, range, planes, angles, factor);
  file.table = unfold(stored, range.symmetry, lines.where());
  require_light(file, lines.where());
  note_gaps(file);
  return file;
}

PhotometricFile read_photometric(const std::string& bytes, const std::string& name) {
  const size_t first = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");  // skips a byte order mark
  if (first != std::string::npos && bytes[first] == '<') return read_tm33(bytes, name);
  return looks_like_ies(lines_of(bytes)) ? read_ies(bytes, name) : read_eulumdat(bytes, name);
}

}  // namespace photorque
