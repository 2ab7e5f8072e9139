#include "images/drawing/colour.h"

#include <numbers>

namespace photorque {
namespace {

// Matrix from linear sRGB to CIE XYZ, D65.
Eigen::Matrix3d xyz_from_linear() {
  return (Eigen::Matrix3d() << 0.4124564, 0.3575761, 0.1804375,  //
          0.2126729, 0.7151522, 0.0721750,                       //
          0.0193339, 0.1191920, 0.9503041)
      .finished();
}

// White point: the matrix times (1, 1, 1), so that greys have exactly a* = b* = 0.
Eigen::Vector3d white_xyz() {
  return xyz_from_linear() * Eigen::Vector3d::Ones();
}

constexpr double lab_knee = 6.0 / 29.0;

double lab_curve(double t) {
  return t > lab_knee * lab_knee * lab_knee ? std::cbrt(t)
                                            : t / (3.0 * lab_knee * lab_knee) + 4.0 / 29.0;
}

double inverse_lab_curve(double f) {
  return f > lab_knee ? f * f * f : 3.0 * lab_knee * lab_knee * (f - 4.0 / 29.0);
}

// Every 17th colour of the published table of 256.
constexpr std::array<uint32_t, 16> viridis_colours = {
    0x440154, 0x481A6C, 0x472F7D, 0x414487, 0x39568C, 0x31688E, 0x2A788E, 0x23888E,
    0x1F988B, 0x22A884, 0x35B779, 0x54C568, 0x7AD151, 0xA5DB36, 0xD2E21B, 0xFDE725};

// Moreland's polar form of CIELAB: M length, s angle from the L* axis, h hue angle.
struct Msh {
  double length = 0.0;
  double angle_rad = 0.0;
  double hue_rad = 0.0;
};

Msh msh_from_rgb(const Rgb& colour) {
  const Lab lab = lab_from_rgb(colour);
  const double length = std::hypot(lab.lightness, lab.a, lab.b);
  return {length, std::acos(lab.lightness / length), std::atan2(lab.b, lab.a)};
}

Rgb rgb_from_msh(const Msh& msh) {
  const double chroma = msh.length * std::sin(msh.angle_rad);
  return rgb_from_lab({msh.length * std::cos(msh.angle_rad), chroma * std::cos(msh.hue_rad),
                       chroma * std::sin(msh.hue_rad)});
}

// Hue of the neutral middle on the side of `end`, such that steps in hue have equal lengths
// (Moreland's AdjustHue). Hues turn away from green, which no map should pass through.
double hue_at_middle(const Msh& end, double middle_length) {
  const double turn = end.angle_rad *
                      std::sqrt(middle_length * middle_length - end.length * end.length) /
                      (end.length * std::sin(end.angle_rad));
  return end.hue_rad > -std::numbers::pi / 3.0 ? end.hue_rad + turn : end.hue_rad - turn;
}

}  // namespace

double linear_from_encoded(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double encoded_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

Lab lab_from_rgb(const Rgb& colour) {
  const Eigen::Vector3d linear(linear_from_encoded(colour.red), linear_from_encoded(colour.green),
                               linear_from_encoded(colour.blue));
  const Eigen::Vector3d f =
      (xyz_from_linear() * linear).cwiseQuotient(white_xyz()).unaryExpr(&lab_curve);
  return {116.0 * f.y() - 16.0, 500.0 * (f.x() - f.y()), 200.0 * (f.y() - f.z())};
}

Rgb rgb_from_lab(const Lab& colour) {
  const double fy = (colour.lightness + 16.0) / 116.0;
  const Eigen::Vector3d f(fy + colour.a / 500.0, fy, fy - colour.b / 200.0);
  const Eigen::Vector3d xyz = f.unaryExpr(&inverse_lab_curve).cwiseProduct(white_xyz());
  const Eigen::Vector3d linear = xyz_from_linear().inverse() * xyz;
  const auto encode = [](double x) { return encoded_from_linear(std::clamp(x, 0.0, 1.0)); };
  return {encode(linear.x()), encode(linear.y()), encode(linear.z())};
}

std::array<uint8_t, 3> rgb_bytes(const Rgb& colour) {
  const auto byte = [](double x) {
    return static_cast<uint8_t>(std::lround(255.0 * std::clamp(x, 0.0, 1.0)));
  };
  return {byte(colour.red), byte(colour.green), byte(colour.blue)};
}

const Rgb& ColourMap::operator()(double fraction) const {
  const double scaled = fraction * static_cast<double>(colours.size());
  if (!(scaled > 0.0)) return colours.front();
  if (scaled >= static_cast<double>(colours.size())) return colours.back();
  return colours[static_cast<size_t>(scaled)];
}

ColourMap viridis() {
  ColourMap map;
  constexpr size_t step = (256 - 1) / (viridis_colours.size() - 1);
  for (size_t i = 0; i < map.colours.size(); ++i) {
    const size_t k = std::min(i / step, viridis_colours.size() - 2);
    const double t = static_cast<double>(i - k * step) / step;
    const Lab from = lab_from_rgb(rgb_from_hex(viridis_colours[k]));
    const Lab to = lab_from_rgb(rgb_from_hex(viridis_colours[k + 1]));
    map.colours[i] = rgb_from_lab({std::lerp(from.lightness, to.lightness, t),
                                   std::lerp(from.a, to.a, t), std::lerp(from.b, to.b, t)});
  }
  return map;
}

ColourMap cool_warm() {
  const Msh cool = msh_from_rgb({0.230, 0.299, 0.754});
  const Msh warm = msh_from_rgb({0.706, 0.016, 0.150});
  const double middle_length = std::max({cool.length, warm.length, 88.0});
  ColourMap map;
  for (size_t i = 0; i < map.colours.size(); ++i) {
    const double fraction = static_cast<double>(i) / static_cast<double>(map.colours.size() - 1);
    const Msh& end = fraction < 0.5 ? cool : warm;
    const double t = std::abs(2.0 * fraction - 1.0);  // 0 in the middle, 1 at the end
    map.colours[i] =
        rgb_from_msh({std::lerp(middle_length, end.length, t), std::lerp(0.0, end.angle_rad, t),
                      std::lerp(hue_at_middle(end, middle_length), end.hue_rad, t)});
  }
  return map;
}

ColourScale colour_scale(const Extent& extent, bool signed_values) {
  const bool is_empty = extent.low > extent.high;
  const double smallest = is_empty ? 0.0 : extent.low, largest = is_empty ? 0.0 : extent.high;
  // If all values have one sign and are far from zero, the colours show only their differences.
  const bool one_sided = smallest > 0.5 * largest || largest < 0.5 * smallest;
  if (signed_values && !one_sided) {
    const double farthest = std::max(std::abs(smallest), std::abs(largest));
    const double reach = farthest > 0.0 ? farthest : 1.0;
    return {-reach, reach, cool_warm()};
  }
  // Differences of this size are rounding errors.
  const bool constant =
      largest - smallest <= 1e-9 * std::max(std::abs(smallest), std::abs(largest));
  if (constant && largest == 0.0) return {0.0, 1.0, viridis()};
  if (constant) return {std::min(largest, 0.0), std::max(largest, 0.0), viridis()};
  const bool from_zero = smallest >= 0.0 && smallest < 0.5 * largest;
  return {from_zero ? 0.0 : smallest, largest, viridis()};
}

ColourScale colour_scale(const Map& map) {
  Extent extent;
  for (const double value : map.value) extent.include(value);
  return colour_scale(extent, map.signed_values);
}

}  // namespace photorque
