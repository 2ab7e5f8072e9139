#include "images/canvas/colour.h"

namespace photorque {
namespace {

// Linear sRGB to CIE XYZ, D65.
Eigen::Matrix3d xyz_from_linear() {
  return (Eigen::Matrix3d() << 0.4124564, 0.3575761, 0.1804375,  //
          0.2126729, 0.7151522, 0.0721750,                       //
          0.0193339, 0.1191920, 0.9503041)
      .finished();
}

// White is what the matrix makes of (1, 1, 1), so that greys have exactly a* = b* = 0.
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

Rgb mixed(const Rgb& from, const Rgb& to, double weight) {
  return {from.red + weight * (to.red - from.red), from.green + weight * (to.green - from.green),
          from.blue + weight * (to.blue - from.blue)};
}

}  // namespace photorque
