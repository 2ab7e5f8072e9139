#include "sources/profiles/intensity_table.h"

#include <cmath>

namespace photorque {
namespace {

// Emitter axes of the frame whose z axis is the pole and whose azimuth counts from its x axis.
Mat3 emitter_from_pole(Pole pole) {
  Mat3 axes;
  switch (pole) {
    case Pole::vertical:  // azimuth from the beam towards +x
      axes.col(0) = Vec3::UnitZ();
      axes.col(1) = Vec3::UnitX();
      axes.col(2) = Vec3::UnitY();
      break;
    case Pole::horizontal:  // azimuth from the beam towards +y
      axes.col(0) = Vec3::UnitZ();
      axes.col(1) = Vec3::UnitY();
      axes.col(2) = Vec3::UnitX();
      break;
    case Pole::beam:
      axes.col(0) = Vec3::UnitX();
      axes.col(1) = -Vec3::UnitY();
      axes.col(2) = Vec3::UnitZ();
      break;
  }
  return axes;
}

}  // namespace

Vec3 table_direction(Pole pole, double polar_rad, double azimuth_rad) {
  const double sine = std::sin(polar_rad);
  return emitter_from_pole(pole) *
         Vec3(sine * std::cos(azimuth_rad), sine * std::sin(azimuth_rad), std::cos(polar_rad));
}

GoniometerAngles table_angles(Pole pole, const Vec3& direction) {
  const Vec3 d = emitter_from_pole(pole).transpose() * direction;
  return {std::atan2(std::hypot(d.x(), d.y()), d.z()), std::atan2(d.y(), d.x())};
}

}  // namespace photorque
