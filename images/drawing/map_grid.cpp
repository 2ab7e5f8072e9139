#include "images/drawing/map.h"

#include <optional>

#include "images/drawing/axis.h"

namespace photorque {
namespace {

// Cells [begin, end) of `cells` that pixel `pixel` of `pixels` covers; at least one.
struct Cells {
  int begin = 0;
  int end = 1;
};

Cells cells_under(int pixel, int pixels, int cells) {
  const auto edge = [&](int p) {
    return static_cast<int>(static_cast<int64_t>(p) * cells / pixels);
  };
  const int begin = edge(pixel);
  return {begin, std::max(begin + 1, edge(pixel + 1))};
}

double mean_of(const Map& map, const Cells& columns, const Cells& rows) {
  double sum = 0.0;
  int count = 0;
  for (int iy = rows.begin; iy < rows.end; ++iy) {
    for (int ix = columns.begin; ix < columns.end; ++ix) {
      const double value = map.value[static_cast<size_t>(iy) * map.width + ix];
      if (!std::isfinite(value)) continue;
      sum += value;
      ++count;
    }
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

// Value of a bin, outside of the map of the nearest one; NaN if it has none.
double value_at(const Map& map, double x, double y) {
  const int column = std::clamp(static_cast<int>(x), 0, map.width - 1);
  const int row = std::clamp(static_cast<int>(y), 0, map.height - 1);
  return map.value[static_cast<size_t>(row) * map.width + column];
}

// Weights of the nodes first − 1 … first + 2 (of `count`) in the Catmull-Rom cubic at t in [0, 1]
// after node `first`; the field is extended linearly beyond the ends.
std::array<double, 4> cubic_weights(double first, int count, double t) {
  std::array<double, 4> weight = {0.5 * t * (t * (2.0 - t) - 1.0),
                                  0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
                                  0.5 * t * (t * (4.0 - 3.0 * t) + 1.0), 0.5 * t * t * (t - 1.0)};
  if (first < 1.0) weight = {0.0, weight[1] + 2.0 * weight[0], weight[2] - weight[0], weight[3]};
  if (first + 2.0 >= count) {
    weight = {weight[0], weight[1] - weight[3], weight[2] + 2.0 * weight[3], 0.0};
  }
  return weight;
}

// Value of a smooth map at x and y, in nodes from its first: the cubic through four nodes per side.
// A node without value uses a neighbouring value. NaN if, of the four nodes around, those without
// value have more than half of the bilinear weight.
double smooth_value(const Map& map, double x, double y) {
  const double left = std::floor(x), below = std::floor(y), s = x - left, t = y - below;
  double there = 0.0, some = std::numeric_limits<double>::quiet_NaN();
  for (const int i : {0, 1}) {
    for (const int j : {0, 1}) {
      const double value = value_at(map, left + i, below + j);
      if (!std::isfinite(value)) continue;
      there += (i == 1 ? s : 1.0 - s) * (j == 1 ? t : 1.0 - t);
      some = value;
    }
  }
  if (!(there >= 0.5)) return std::numeric_limits<double>::quiet_NaN();
  const auto across = cubic_weights(left, map.width, s);
  const auto up = cubic_weights(below, map.height, t);
  double sum = 0.0;
  for (size_t j = 0; j < 4; ++j) {
    for (size_t i = 0; i < 4; ++i) {
      const double value =
          value_at(map, left + static_cast<double>(i) - 1.0, below + static_cast<double>(j) - 1.0);
      sum += across[i] * up[j] * (std::isfinite(value) ? value : some);
    }
  }
  return sum;
}

// Whether the values of a smooth map fill exactly the circle through its outermost nodes.
bool is_round(const Map& map) {
  if (!map.smooth || map.width != map.height || map.width < 8) return false;
  const double middle = 0.5 * (map.width - 1);
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const double outside = std::hypot(column - middle, row - middle) - middle;
      const bool has_value =
          std::isfinite(map.value[static_cast<size_t>(row) * map.width + column]);
      if (std::abs(outside) > 1e-6 && has_value == (outside > 0.0)) return false;
    }
  }
  return true;
}

// A round map extended linearly along the radius beyond the rim, for interpolation there.
Map beyond_rim(Map map) {
  const double middle_x = 0.5 * (map.width - 1), middle_y = 0.5 * (map.height - 1);
  const double rim = std::min(middle_x, middle_y);
  // In nodes: so far inside the rim all four surrounding nodes have values.
  constexpr double step = 1.5;
  if (rim < 2.0 * step) return map;
  const auto extend = [&](const std::vector<double>& values) {
    if (values.empty()) return values;
    Map inside = map;
    inside.value = values;
    std::vector<double> extended = values;
    for (int row = 0; row < map.height; ++row) {
      for (int column = 0; column < map.width; ++column) {
        const double x = column - middle_x, y = row - middle_y, distance = std::hypot(x, y);
        double& value = extended[static_cast<size_t>(row) * map.width + column];
        if (std::isfinite(value) || distance > rim + 2.0 * step) continue;
        const auto at = [&](double radius) {
          return smooth_value(inside, middle_x + x * radius / distance,
                              middle_y + y * radius / distance);
        };
        const double outer = at(rim - step), inner = at(rim - 2.0 * step);
        value = outer + (outer - inner) * (distance - rim + step) / step;
      }
    }
    return extended;
  };
  std::vector<double> value = extend(map.value), error = extend(map.standard_error);
  map.value = std::move(value);
  map.standard_error = std::move(error);
  return map;
}

Ticks contour_levels(const ColourScale& scale) {
  constexpr int most_levels = 17;
  return linear_ticks(scale.low, scale.high, most_levels);
}

// Value of a map at a pixel of a picture of it.
double pixel_value(const Map& of, int column, int row, int columns, int rows) {
  if (!of.smooth) {
    return mean_of(of, cells_under(column, columns, of.width),
                   cells_under(rows - 1 - row, rows, of.height));
  }
  return smooth_value(of, (column + 0.5) * (of.width - 1) / columns,
                      (rows - row - 0.5) * (of.height - 1) / rows);
}

// Paler than the colours of a signed scale, darker than its middle.
constexpr Rgb unsure_grey = {0.74, 0.74, 0.74};

// The values of a map at the pixels of a picture. A smooth map has thin contour lines at equal
// steps; a pixel is darker the nearer it is to a line.
class PixelField {
 public:
  PixelField(const Map& stored, const ColourScale& scale, int columns, int rows)
      : scale_(scale), columns_(columns), rows_(rows), is_round_(is_round(stored)) {
    const Map map = is_round_ ? beyond_rim(stored) : stored;
    if (stored.signed_values && !stored.standard_error.empty()) {
      errors_ = map;
      errors_->value = map.standard_error;
    }
    const Ticks ticks = contour_levels(scale);
    if (map.smooth && ticks.values.size() > 1) step_ = ticks.values[1] - ticks.values[0];
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        value_.push_back(part_within_rim(column, row) > 0.0
                             ? pixel_value(map, column, row, columns, rows)
                             : std::numeric_limits<double>::quiet_NaN());
      }
    }
  }

  double value(int column, int row) const {
    return value_[static_cast<size_t>(row) * columns_ + column];
  }

  // Whether the value is within two standard errors of zero.
  bool is_unsure(int column, int row) const {
    if (!errors_) return false;
    const double error = pixel_value(*errors_, column, row, columns_, rows_);
    return error > 0.0 && std::abs(value(column, row)) < 2.0 * error;
  }

  uint32_t pixel(int column, int row) const {
    const double value = this->value(column, row);
    if (!std::isfinite(value)) return 0u;
    constexpr double half_width = 0.9, darkest = 0.55;  // pixels
    const double right = this->value(std::min(column + 1, columns_ - 1), row);
    const double below = this->value(column, std::min(row + 1, rows_ - 1));
    const double slope = std::hypot(right - value, below - value);
    Rgb colour = scale_(value);
    if (step_ > 0.0 && std::isfinite(slope) && slope > 1e-3 * step_ * 1e-2) {
      const double away = std::abs(value - step_ * std::round(value / step_)) / slope;
      const double ink = darkest * std::clamp(half_width + 0.5 - away, 0.0, 1.0);
      for (double* channel : {&colour.red, &colour.green, &colour.blue}) *channel *= 1.0 - ink;
    }
    if (is_unsure(column, row)) colour = unsure_grey;
    const auto opacity = static_cast<uint32_t>(std::lround(255.0 * part_within_rim(column, row)));
    return (opaque_argb(rgb_bytes(colour)) & 0x00FFFFFFu) | opacity << 24;
  }

 private:
  // Fraction of a pixel within the rim of a round map, 0 to 1; 1 for other maps.
  double part_within_rim(int column, int row) const {
    if (!is_round_) return 1.0;
    const double x = 2.0 * (column + 0.5) / columns_ - 1.0, y = 2.0 * (row + 0.5) / rows_ - 1.0;
    return std::clamp(0.5 * std::min(columns_, rows_) * (1.0 - std::hypot(x, y)) + 0.5, 0.0, 1.0);
  }

  const ColourScale& scale_;
  int columns_, rows_;
  bool is_round_;
  double step_ = 0.0;  // between contour lines
  std::vector<double> value_;
  std::optional<Map> errors_ = {};  // the standard errors of signed values
};

}  // namespace

std::vector<ContourLabel> contour_labels(const Map& map, const ColourScale& scale, int columns,
                                         int rows, double room) {
  std::vector<ContourLabel> labels;
  const Ticks levels = contour_levels(scale);
  if (!map.smooth || levels.values.size() < 3) return labels;
  const PixelField field(map, scale, columns, rows);
  const auto edge = static_cast<int>(0.6 * room);
  // Whether a whole label has values around it.
  const auto is_inside = [&](int column, int row) {
    for (const int i : {-edge, edge}) {
      for (const int j : {-edge, 0, edge}) {
        const int x = column + i, y = row + j;
        if (x < 0 || y < 0 || x >= columns || y >= rows || !std::isfinite(field.value(x, y))) {
          return false;
        }
      }
    }
    return true;
  };
  const auto distance_to_others = [&](double column, double row) {
    double nearest = 1e9;
    for (const ContourLabel& other : labels) {
      nearest = std::min(nearest, std::hypot(other.column - column, other.row - row));
    }
    return nearest;
  };
  const auto first =
      static_cast<int64_t>(std::llround(levels.values[0] / (levels.values[1] - levels.values[0])));
  for (size_t l = 0; l < levels.values.size(); ++l) {
    const double level = levels.values[l];
    if ((first + static_cast<int64_t>(l)) % 2 != 0 || level == 0.0) continue;
    // The flattest part of the line has the most room for the label.
    std::optional<ContourLabel> best;
    double least_slope = std::numeric_limits<double>::infinity();
    for (int row = edge; row + edge < rows; row += 2) {
      for (int column = edge; column + edge < columns; column += 2) {
        const double here = field.value(column, row);
        if (!std::isfinite(here) || !is_inside(column, row)) continue;
        const double right = 0.5 * (field.value(column + 1, row) - field.value(column - 1, row));
        const double down = 0.5 * (field.value(column, row + 1) - field.value(column, row - 1));
        const double slope = std::hypot(right, down);
        if (!(std::abs(here - level) < 1.5 * slope) || slope >= least_slope) continue;
        if (distance_to_others(column, row) < 2.0 * room) continue;
        if (field.is_unsure(column, row)) continue;
        least_slope = slope;
        // Angle along the line with upright letters.
        double turn = std::atan2(right, down);
        if (turn > 0.5 * std::numbers::pi) turn -= std::numbers::pi;
        if (turn <= -0.5 * std::numbers::pi) turn += std::numbers::pi;
        best = {static_cast<double>(column), static_cast<double>(row), turn, level,
                levels.labels[l]};
      }
    }
    if (best) labels.push_back(*best);
  }
  return labels;
}

bool is_unsure(const Map& map, size_t bin) {
  if (!map.signed_values || map.standard_error.empty()) return false;
  const double error = map.standard_error[bin];
  return error > 0.0 && std::abs(map.value[bin]) < 2.0 * error;
}

std::vector<uint32_t> map_pixels(const Map& map, const ColourScale& scale, int columns, int rows) {
  const PixelField field(map, scale, columns, rows);
  std::vector<uint32_t> pixels;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) pixels.push_back(field.pixel(column, row));
  }
  return pixels;
}

}  // namespace photorque
