#include "images/drawing/map_grid.h"

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

}  // namespace

std::vector<uint32_t> map_pixels(const Map& map, const ColourScale& scale, int columns, int rows) {
  std::vector<uint32_t> pixels(static_cast<size_t>(columns) * rows, 0u);
  for (int row = 0; row < rows; ++row) {
    const Cells map_rows = cells_under(rows - 1 - row, rows, map.height);
    for (int column = 0; column < columns; ++column) {
      const double value = mean_of(map, cells_under(column, columns, map.width), map_rows);
      if (std::isnan(value)) continue;
      const auto [red, green, blue] = rgb_bytes(scale(value));
      pixels[static_cast<size_t>(row) * columns + column] =
          0xFF000000u | uint32_t{red} << 16 | uint32_t{green} << 8 | uint32_t{blue};
    }
  }
  return pixels;
}

}  // namespace photorque
