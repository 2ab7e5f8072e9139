// Photometric files as IES LM-63-2019 text, for round trips through the reader.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/constants.h"
#include "core/text/parse.h"
#include "sources/photometry/file.h"

namespace photorque {
namespace ies_writer {

// An angle in degrees without the rounding of the way there: 0.1, not 0.09999999999999999.
inline std::string degrees(double angle_rad) {
  const double degrees = angle_rad / degree_rad;
  const double rounded = std::round(degrees * 1e9) / 1e9;
  return shortest(std::abs(rounded - degrees) < 1e-12 * (1.0 + std::abs(degrees)) ? rounded
                                                                                  : degrees);
}

class Lines {
 public:
  explicit Lines(std::string& text) : text_(text) {}
  void add(const std::string& word) {
    constexpr size_t longest = 120;
    if (column_ > 0 && column_ + 1 + word.size() > longest) end();
    if (column_ > 0) text_ += ' ';
    text_ += word;
    column_ += word.size() + 1;
  }
  void end() {
    text_ += '\n';
    column_ = 0;
  }

 private:
  std::string& text_;
  size_t column_ = 0;
};

// Angles and values as LM-63 orders them: horizontal outer, vertical inner.
struct Goniometer {
  int type = 1;
  std::vector<double> vertical_rad, horizontal_rad;
  std::vector<size_t> order;  // into the table's intensity
};

inline Goniometer goniometer_of(const IntensityTable& table) {
  const size_t knots = table.polar_rad.size(), planes = table.planes();
  Goniometer g;
  if (table.pole == Pole::beam) {
    g.vertical_rad = table.polar_rad;
    g.horizontal_rad = table.azimuth_rad;
    if (planes > 1) g.horizontal_rad.push_back(table.azimuth_rad.front() + 2.0 * pi);
    for (size_t j = 0; j < g.horizontal_rad.size(); ++j) {
      for (size_t i = 0; i < knots; ++i) g.order.push_back((j % planes) * knots + i);
    }
    return g;
  }
  std::vector<double> latitude_rad;
  for (size_t i = knots; i-- > 0;) latitude_rad.push_back(0.5 * pi - table.polar_rad[i]);
  const bool type_a = table.pole == Pole::vertical;
  g.type = type_a ? 3 : 2;
  g.vertical_rad = type_a ? latitude_rad : table.azimuth_rad;
  g.horizontal_rad = type_a ? table.azimuth_rad : latitude_rad;
  for (size_t h = 0; h < g.horizontal_rad.size(); ++h) {
    for (size_t v = 0; v < g.vertical_rad.size(); ++v) {
      const size_t latitude = type_a ? v : h, plane = type_a ? h : v;
      g.order.push_back(plane * knots + (knots - 1 - latitude));
    }
  }
  return g;
}

}  // namespace ies_writer

// LM-63-2019 text that read_ies() turns into the same table, opening, labels, stated flux and input
// power, to the last bit but for angles, which are written in degrees.
inline std::string write_ies(const PhotometricFile& file) {
  std::string text = "IES:LM-63-2019\n";
  for (const auto& [keyword, value] : file.labels) {
    text += (keyword.empty() ? "[OTHER] " : "[" + keyword + "] ") + value + "\n";
  }
  text += "TILT=NONE\n";
  using namespace ies_writer;
  const Goniometer g = goniometer_of(file.table);
  Lines lines(text);
  const double sign = file.opening.shape == Opening::Shape::ellipse ? -1.0 : 1.0;
  const std::string counts = std::to_string(g.vertical_rad.size()) + " " +
                             std::to_string(g.horizontal_rad.size()) + " " + std::to_string(g.type);
  lines.add("1 " + shortest(file.stated_flux_lm.value_or(-1.0)) + " 1 " + counts + " 2 " +
            shortest(sign * file.opening.y_m) + " " + shortest(sign * file.opening.x_m) + " 0");
  lines.end();
  // 1.00001 of LM-63-2019 table 2: "undefined" kind of file.
  lines.add("1 1.00001 " + shortest(file.input_power_W));
  lines.end();
  for (const double angle_rad : g.vertical_rad) lines.add(degrees(angle_rad));
  lines.end();
  for (const double angle_rad : g.horizontal_rad) lines.add(degrees(angle_rad));
  lines.end();
  for (const size_t at : g.order) lines.add(shortest(file.table.intensity[at]));
  lines.end();
  return text;
}

}  // namespace photorque
