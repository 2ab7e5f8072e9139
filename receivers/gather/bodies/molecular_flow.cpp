#include "receivers/gather/bodies/molecular_flow.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {

MolecularFlux::MolecularFlux(double speed_ratio, const Vec3& travel, const Vec3& normal)
    : speed_ratio_(speed_ratio),
      travel_(travel),
      normal_(normal),
      cosine_(-normal.dot(travel)),
      z_(std::erfc(-cosine_ * speed_ratio)),
      p_(std::exp(-std::pow(cosine_ * speed_ratio, 2)) / speed_ratio) {}

Vec3 MolecularFlux::arriving() const {
  const double pressure = z_ / (2.0 * speed_ratio_ * speed_ratio_);
  return (cosine_ * z_ + p_ / std::sqrt(pi)) * travel_ - pressure * normal_;
}

Vec3 MolecularFlux::force(const GasWall& wall) const {
  const double at_wall = 2.0 * wall.temperature_ratio / (speed_ratio_ * speed_ratio_);
  const double leaving = std::sqrt(0.5 * (1.0 + wall.accommodation * (at_wall - 1.0)));
  return arriving() - 0.5 * leaving * (std::sqrt(pi) * cosine_ * z_ + p_) * normal_;
}

bool MolecularFlux::is_none() const {
  constexpr double negligible = 1e-12;  // against the flux on a side that faces the flow
  return cosine_ < 0.0 && p_ < negligible;
}

}  // namespace photorque
