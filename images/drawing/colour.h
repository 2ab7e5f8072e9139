// Colours as displays show them and as eyes see them, and colour maps for scalar fields:
// perceptually even, and readable by colour-blind people.
#pragma once

#include <array>
#include <cstdint>

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

// Proportional to light, as averaging needs it, from the encoded value; and back. Both in [0, 1].
double linear_from_encoded(double encoded);
double encoded_from_linear(double linear);

// Source: CIE 15:2004, section 8.2.1; matrix from the primaries of IEC 61966-2-1.
Lab lab_from_rgb(const Rgb& colour);
// Colours outside of sRGB are clipped per component.
Rgb rgb_from_lab(const Lab& colour);

// Each component rounded to 0 … 255.
std::array<uint8_t, 3> rgb_bytes(const Rgb& colour);
// 0xRRGGBB.
constexpr Rgb rgb_from_hex(uint32_t hex) {
  return {((hex >> 16) & 0xFF) / 255.0, ((hex >> 8) & 0xFF) / 255.0, (hex & 0xFF) / 255.0};
}

// 256 colours for the fractions 0 to 1.
struct ColourMap {
  std::array<Rgb, 256> colours;
  // The colour at `fraction`, clamped to [0, 1].
  const Rgb& operator()(double fraction) const;
};

// Dark violet to yellow; lightness rises evenly. For quantities that do not change sign.
// Source: viridis, N. Smith and S. van der Walt (2015, CC0), 16 of its 256 colours interpolated in
// CIELAB; within ΔE*ab = 1.2 of the published table.
ColourMap viridis();

// Blue over light grey (at 1/2) to red; lightness rises evenly to the middle and falls again. For
// signed quantities.
// Source: K. Moreland, "Diverging Color Maps for Scientific Visualization" (ISVC 2009): its
// construction in the polar form of CIELAB, with its pair of cool and warm ends.
ColourMap cool_warm();

// Which colour a value has: `low` at the start of the map, `high` at its end; low < high.
struct ColourScale {
  double low = 0.0;
  double high = 1.0;
  ColourMap map;
  const Rgb& operator()(double value) const { return map((value - low) / (high - low)); }
};

// The scale for values from `smallest` to `largest`. Unsigned: from zero, unless all values lie in
// the upper half of [0, largest], where a map from zero would hide differences. Signed: blue to red
// with zero in the middle, unless all lie on one side of zero and far from it. Constant values get
// a scale that shows them as such.
ColourScale colour_scale(double smallest, double largest, bool signed_values);

// The scale for the finite values of a map; [0, 1] or [−1, 1] if there are none.
ColourScale colour_scale(const Map& map);

}  // namespace photorque
