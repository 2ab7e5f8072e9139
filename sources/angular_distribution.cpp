#include "sources/angular_distribution.h"

#include <algorithm>
#include <utility>

#include "sources/inverse_flux.h"
#include "sources/vector_math.h"

namespace photorque {

AngularDistribution::AngularDistribution(AngularProfile core, std::optional<Halo> halo) {
  halo_fraction_ = halo ? halo->fraction : 0.0;
  const auto add = [this](AngularProfile profile, double share) {
    const InverseFlux inverse(profile);
    const auto& table = inverse.coefficients();
    coefficients_.insert(coefficients_.end(), table.begin(), table.end());
    parts_.push_back({std::move(profile), share / inverse.flux()});
  };
  add(std::move(core), 1.0 - halo_fraction_);
  if (halo_fraction_ > 0.0) add(std::move(halo->profile), halo_fraction_);

  // Profiles rise or fall steadily, so that the maximum is on the axis or at an edge; the steps in
  // between catch a sum of both.
  constexpr int steps = 256;
  for (const Part& part : parts_) {
    for (int i = 0; i <= steps; ++i) {
      const double angle_rad = part.profile.end_rad * i / steps;
      brightest_ = std::max(brightest_, intensity_per_flux(angle_rad));
    }
  }
}

double AngularDistribution::intensity_per_flux(double angle_rad) const {
  double sum = 0.0;
  for (const Part& part : parts_) sum += part.intensity_factor * part.profile(angle_rad);
  return sum;
}

std::vector<double> AngularDistribution::edges_rad() const {
  std::vector<double> edges;
  for (const Part& part : parts_) edges.push_back(part.profile.end_rad);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

double AngularDistribution::relative_intensity(double angle_rad) const {
  return std::min(1.0, intensity_per_flux(angle_rad) / brightest_);
}

void AngularDistribution::rises(const std::array<uint32_t, ray_block>& bits,
                                std::array<double, ray_block>& rise) const {
  const double halo = halo_fraction_;
  const double per_halo = halo > 0.0 ? 1.0 / halo : 0.0;
  const double per_core = 1.0 / (1.0 - halo);
  const double* table = coefficients_.data();
  constexpr double largest_share = 1.0 - 0x1p-53;
  // Two loops: the arithmetic is vectorised, the look-up need not be.
  std::array<uint64_t, ray_block> interval;
  std::array<double, ray_block> t;
  for (int i = 0; i < ray_block; ++i) {
    const double outside = remainder_of(bits[i]);
    const bool in_halo = outside < halo;
    // Each part stretched to the whole interval again; the bounds only mend rounding.
    double share = in_halo ? outside * per_halo : (outside - halo) * per_core;
    share = share < InverseFlux::smallest_share ? InverseFlux::smallest_share : share;
    share = share > largest_share ? largest_share : share;
    const InverseFlux::Place place = InverseFlux::place(share);
    interval[i] = place.interval + (in_halo ? InverseFlux::intervals : 0);
    t[i] = place.t;
  }
  for (int i = 0; i < ray_block; ++i) {
    const double* c = table + 4 * interval[i];
    rise[i] = c[0] + t[i] * (c[1] + t[i] * (c[2] + t[i] * c[3]));
  }
}

}  // namespace photorque
