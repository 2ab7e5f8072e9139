// Whether optics can make a beam at all.
#pragma once

#include <optional>
#include <string>

namespace photorque {

// The emitting area inside a lamp.
struct Die {
  double area_m2 = 0.0;
  double index = 1.0;  // refractive index of what surrounds it: 1 bare, 1.4–1.5 in a dome
};

// No lossless optics makes light brighter than its source: a Lambertian die in a medium of index n
// has the etendue π n² A, and a beam needs aperture area × effective solid angle (flux over largest
// intensity) at least as large. One line for people if it is not, with the aperture that would do.
// Source: R. Winston, J. C. Miñano, P. Benítez, Nonimaging Optics (2005), chapter 2.
std::optional<std::string> etendue_notice(const std::string& name, const Die& die,
                                          double aperture_diameter_m,
                                          double effective_solid_angle_sr);

}  // namespace photorque
