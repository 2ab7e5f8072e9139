// Finished pictures as plain values.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace photorque {

// An opaque 8-bit sRGB picture. Pixel (column, row) is at index 3·(row·width + column); row 0 is
// the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;

  std::array<uint8_t, 3> pixel(int column, int row) const {
    const size_t i = 3 * (static_cast<size_t>(row) * width + column);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

}  // namespace photorque
