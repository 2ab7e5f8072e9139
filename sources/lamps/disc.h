// A lamp behind a round aperture.
#pragma once

#include "raytrace/emitter.h"
#include "sources/profiles/angular_distribution.h"

namespace photorque {

// Light from every point of a disc alike: position uniform over the area, direction independent of
// position. The disc lies at z = 0, directions are measured from +z.
class DiscLamp : public Emitter {
 public:
  // power > 0, aperture diameter > 0; the caller checks.
  DiscLamp(double power_W, double aperture_diameter_m, AngularDistribution directions);

  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override;
  double relative_intensity(double angle_rad) const override;

 private:
  double power_W_;
  double aperture_radius_m_;
  AngularDistribution directions_;
};

}  // namespace photorque
