// A lamp behind a round aperture, and whether optics can make its beam at all.
#pragma once

#include <optional>
#include <string>

#include "raytrace/emitter.h"
#include "sources/profiles/angular_profile.h"

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

// The emitting area inside a lamp.
struct Die {
  double area_m2 = 0.0;
  double index = 1.0;  // refractive index around it: 1 bare, 1.4–1.5 in a dome
};

// No lossless optics makes light brighter than its source: a Lambertian die in a medium of index n
// has the etendue π n² A, and a beam needs aperture area × effective solid angle (flux over largest
// intensity) at least as large. A notice if it is not, with a sufficient aperture.
// Source: R. Winston, J. C. Miñano, P. Benítez, Nonimaging Optics (2005), chapter 2.
std::optional<std::string> etendue_notice(const std::string& name, const Die& die,
                                          double aperture_diameter_m,
                                          double effective_solid_angle_sr);

}  // namespace photorque
