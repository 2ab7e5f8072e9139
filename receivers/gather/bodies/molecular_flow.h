// The force of a free-molecular gas on a surface: of the residual atmosphere on a spacecraft.
//
// A side of a surface with the outer normal n takes up, per area and per dynamic pressure ½ρv²,
//
//   f = (γZ + P/√π) û − (Z/(2S²) + ½ r (γ√π Z + P)) n,
//   γ = −n·û,  Z = 1 + erf(γS),  P = exp(−γ²S²)/S,  r² = ½ (1 + α (2 T_w/(T S²) − 1)),
//
// with the unit vector û of the flow's travel, the speed ratio S = v/√(2RT) of a gas at T, and the
// energy accommodation α at a wall at T_w, from which molecules leave by Lambert's law with the
// speed r v. Sources: L. H. Sentman, LMSC-448514 (1961); for r, E. Doornbos, Thermospheric Density
// and Wind Determination from Satellite Dynamics (2012), eq. 3.56 to 3.60.
#pragma once

#include <cmath>

#include "core/constants.h"
#include "core/transform.h"

namespace photorque {

// A surface in a gas.
struct GasWall {
  double accommodation = 1.0;      // α in [0, 1]
  double temperature_ratio = 0.3;  // T_w/T > 0
};

// A flow on a side whose normal is given.
class MolecularFlux {
 public:
  // `travel` and `normal` are of unit length; the speed ratio is positive.
  MolecularFlux(double speed_ratio, const Vec3& travel, const Vec3& normal)
      : speed_ratio_(speed_ratio),
        travel_(travel),
        normal_(normal),
        cosine_(-normal.dot(travel)),
        z_(std::erfc(-cosine_ * speed_ratio)),
        p_(std::exp(-std::pow(cosine_ * speed_ratio, 2)) / speed_ratio) {}

  // The momentum that arriving molecules bring: f without the term in r. Its direction is the mean
  // of theirs.
  Vec3 arriving() const {
    const double pressure = z_ / (2.0 * speed_ratio_ * speed_ratio_);
    return (cosine_ * z_ + p_ / std::sqrt(pi)) * travel_ - pressure * normal_;
  }
  // f.
  Vec3 force(const GasWall& wall) const {
    const double at_wall = 2.0 * wall.temperature_ratio / (speed_ratio_ * speed_ratio_);
    const double leaving = std::sqrt(0.5 * (1.0 + wall.accommodation * (at_wall - 1.0)));
    return arriving() - 0.5 * leaving * (std::sqrt(pi) * cosine_ * z_ + p_) * normal_;
  }
  // No molecule arrives: of a side that is turned away from a fast flow.
  bool is_none() const {
    constexpr double negligible = 1e-12;  // against the flux on a side that faces the flow
    return cosine_ < 0.0 && p_ < negligible;
  }

 private:
  double speed_ratio_;
  Vec3 travel_, normal_;
  double cosine_, z_, p_;
};

}  // namespace photorque
