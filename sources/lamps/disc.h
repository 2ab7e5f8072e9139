// A lamp behind a round aperture, and the check that its beam is physically possible.
#pragma once

#include <optional>
#include <string>

#include "raytrace/emitter.h"
#include "sources/profiles/angular_profile.h"

namespace photorque {

// Light from a disc whose points all radiate alike: the position is uniform over the area, the
// direction is independent of the position. The disc lies at z = 0, directions are measured
// from +z.
class DiscLamp : public Emitter {
 public:
  // power > 0 and aperture diameter > 0; the caller checks this.
  DiscLamp(double power_W, double aperture_diameter_m, AngularDistribution directions);

  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override;
  double relative_intensity(double angle_rad) const override;

 private:
  double power_W_;
  double aperture_radius_m_;
  AngularDistribution directions_;
};

// The emitting area inside a lamp.
struct Die {
  double area_m2 = 0.0;
  double index = 1.0;  // refractive index around it: 1 for a bare die, 1.4–1.5 in a dome
};

// A notice if optics cannot produce the beam, with an aperture that would suffice. Lossless optics
// cannot make light brighter than its source: a Lambertian die in a medium of index n has the
// etendue π n² A. For a beam, aperture area × effective solid angle (flux over largest intensity)
// must be at least as large.
// Source: R. Winston, J. C. Miñano, P. Benítez, Nonimaging Optics (2005), chapter 2.
std::optional<std::string> etendue_notice(const std::string& name, const Die& die,
                                          double aperture_diameter_m,
                                          double effective_solid_angle_sr);

}  // namespace photorque
