// Colours in display and perceptual coordinates, and colour maps for scalar fields that are
// perceptually uniform and readable for colour-blind readers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/product.h"

namespace photorque {

// sRGB as encoded for a display (IEC 61966-2-1), each in [0, 1].
struct Rgb {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
};

// CIE 1976 L*a*b* relative to the white of sRGB (D65): lightness in [0, 100].
struct Lab {
  double lightness = 0.0;
  double a = 0.0;
  double b = 0.0;
};

// Conversion between the encoded value and the linear value, which is proportional to light and
// suitable for averages. Both in [0, 1].
double linear_from_encoded(double encoded);
double encoded_from_linear(double linear);

// Source: CIE 15:2004, section 8.2.1; matrix from the primaries of IEC 61966-2-1.
Lab lab_from_rgb(const Rgb& colour);
// Colours outside of sRGB are clipped per component.
Rgb rgb_from_lab(const Lab& colour);

// Components rounded to 0 … 255.
std::array<uint8_t, 3> rgb_bytes(const Rgb& colour);
// An opaque pixel 0xFFRRGGBB.
constexpr uint32_t opaque_argb(const std::array<uint8_t, 3>& rgb) {
  return 0xFF000000u | uint32_t{rgb[0]} << 16 | uint32_t{rgb[1]} << 8 | uint32_t{rgb[2]};
}
// Colour 0xRRGGBB.
constexpr Rgb rgb_from_hex(uint32_t hex) {
  return {((hex >> 16) & 0xFF) / 255.0, ((hex >> 8) & 0xFF) / 255.0, (hex & 0xFF) / 255.0};
}

// 256 colours for the fractions 0 to 1.
struct ColourMap {
  std::array<Rgb, 256> colours;
  // Colour at `fraction`, clamped to [0, 1].
  const Rgb& operator()(double fraction) const;
};

// Dark violet to yellow with evenly rising lightness, for quantities that do not change sign.
// Source: viridis, N. Smith and S. van der Walt (2015, CC0), 16 of its 256 colours interpolated in
// CIELAB; within ΔE*ab = 1.2 of the published table.
ColourMap viridis();

// Blue over light grey (at 1/2) to red, for signed quantities. Lightness rises evenly to the middle
// and falls evenly beyond.
// Source: K. Moreland, "Diverging Color Maps for Scientific Visualization" (ISVC 2009): its
// construction in the polar form of CIELAB, with its pair of cool and warm ends.
ColourMap cool_warm();

// Colours of values from `low` (start of the map) to `high` (end); low < high.
struct ColourScale {
  double low = 0.0;
  double high = 1.0;
  ColourMap map;
  const Rgb& operator()(double value) const { return map((value - low) / (high - low)); }
};

// Range of the finite values that it includes; low > high if there are none.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double value, bool log = false) {
    if (!std::isfinite(value) || (log && value <= 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// Scale for the values of a range; [0, 1] or [−1, 1] if there are none. Unsigned: from zero, unless
// all values are in the upper half of [0, largest], where a scale from zero would hide differences.
// Signed: blue to red with zero in the middle, unless all values are on one side of zero and far
// from it. Constant values get a scale that shows them as constant.
ColourScale colour_scale(const Extent& extent, bool signed_values);
// Colour scale for the range of finite values of a map.
ColourScale colour_scale(const Map& map);

}  // namespace photorque
