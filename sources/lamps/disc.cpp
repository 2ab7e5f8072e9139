#include "sources/lamps/disc.h"

#include <cmath>
#include <utility>

#include "core/constants.h"
#include "core/text/format.h"
#include "sources/profiles/sampling.h"

namespace photorque {

DiscLamp::DiscLamp(double power_W, double aperture_diameter_m, AngularDistribution directions)
    : power_W_(power_W),
      aperture_radius_m_(0.5 * aperture_diameter_m),
      directions_(std::move(directions)) {}

void DiscLamp::emit(const SampleBlock& samples, RayBlock& rays) const {
  ValueBlock rise;
  fill_disc(aperture_radius_m_, samples.bits[0], samples.bits[1], rays.origin_m);
  directions_.rises(samples.bits[2], rise);
  fill_directions(rise, samples.bits[3], rays.direction);
}

double DiscLamp::relative_intensity(double angle_rad) const {
  return directions_.relative_intensity(angle_rad);
}

std::optional<std::string> etendue_notice(const std::string& name, const Die& die,
                                          double aperture_diameter_m,
                                          double effective_solid_angle_sr) {
  const double die_etendue = pi * die.index * die.index * die.area_m2;
  const double aperture_m2 = 0.25 * pi * aperture_diameter_m * aperture_diameter_m;
  const double fraction = aperture_m2 * effective_solid_angle_sr / die_etendue;
  if (fraction >= 1.0) return std::nullopt;
  return name + printed(
                    ": no optics can put more than %.3g %% of this die's light into such a beam; "
                    "the aperture is %.4g mm, all of it needs at least %.4g mm",
                    100.0 * fraction, 1e3 * aperture_diameter_m,
                    1e3 * aperture_diameter_m / std::sqrt(fraction));
}

}  // namespace photorque
