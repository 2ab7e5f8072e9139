// Colours as displays show them, and as eyes see them.
#pragma once

#include <array>
#include <cstdint>

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

// `weight` 0 is `from`, 1 is `to`; of the encoded values.
Rgb mixed(const Rgb& from, const Rgb& to, double weight);

}  // namespace photorque
