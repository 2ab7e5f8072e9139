#include "sources/lamps/etendue.h"

#include <cmath>
#include <cstdio>

#include "core/constants.h"

namespace photorque {

std::optional<std::string> etendue_notice(const std::string& name, const Die& die,
                                          double aperture_diameter_m,
                                          double effective_solid_angle_sr) {
  const double die_etendue = pi * die.index * die.index * die.area_m2;
  const double aperture_m2 = 0.25 * pi * aperture_diameter_m * aperture_diameter_m;
  const double fraction = aperture_m2 * effective_solid_angle_sr / die_etendue;
  if (fraction >= 1.0) return std::nullopt;
  char text[256];
  std::snprintf(text, sizeof text,
                ": no optics can put more than %.3g %% of this die's light into such a beam; "
                "the aperture is %.4g mm, all of it needs at least %.4g mm",
                100.0 * fraction, 1e3 * aperture_diameter_m,
                1e3 * aperture_diameter_m / std::sqrt(fraction));
  return name + text;
}

}  // namespace photorque
