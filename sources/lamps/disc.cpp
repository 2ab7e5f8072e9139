#include "sources/lamps/disc.h"

#include <utility>

#include "sources/profiles/block_maps.h"

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

}  // namespace photorque
