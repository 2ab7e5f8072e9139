// The directions of a lamp: one profile, or a core and a halo about it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "raytrace/emitter.h"
#include "sources/profiles/angular_profile.h"

namespace photorque {

// A halo of stray light: this fraction of all flux, in [0, 1), with a profile of its own.
struct Halo {
  AngularProfile profile;
  double fraction = 0.0;
};

// Immutable. Directions are sampled with equal weight, to 1e-6 of the flux within any cone.
class AngularDistribution {
 public:
  explicit AngularDistribution(AngularProfile core, std::optional<Halo> halo = std::nullopt);

  // Radiant intensity over its maximum, in [0, 1].
  double relative_intensity(double angle_rad) const;

  // Where a profile ends, rising; the last is where all light ends.
  std::vector<double> edges_rad() const;

  // Flux over the largest intensity [sr]: the solid angle that a beam as bright would fill evenly.
  double effective_solid_angle_sr() const { return 1.0 / brightest_; }

  // The cosine's fall from the axis, 1 − cos θ, for each 32-bit fraction; rises with the fraction
  // within the core and, for the last `halo.fraction` of fractions, within the halo.
  void rises(const std::array<uint32_t, ray_block>& bits, std::array<float, ray_block>& rise) const;

 private:
  double intensity_per_flux(double angle_rad) const;

  struct Part {
    AngularProfile profile;
    double intensity_factor;  // makes the flux of the profile its fraction of the whole
  };
  std::vector<Part> parts_;
  double halo_fraction_ = 0.0;
  double brightest_ = 0.0;           // largest intensity per flux [1/sr]
  std::vector<float> coefficients_;  // tables of InverseFlux, core before halo
};

}  // namespace photorque
