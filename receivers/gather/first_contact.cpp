#include "receivers/gather/first_contact.h"

namespace photorque {

FirstContact::FirstContact(const OpticalSurface& surface, bool front, const BandValues& fraction,
                           int bands)
    : surface_(surface), front_(front), fraction_(fraction), bands_(bands) {
  for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
    specular_ += fraction[band] * surface.specular[band];
    diffuse_ += fraction[band] * surface.diffuse[band];
    transmitted_ += fraction[band] * surface.transmitted[band];
  }
}

// What arrives less the expectation of what leaves over all components, heat radiation included.
Vec3 FirstContact::by_law(const Vec3& direction, const Vec3& normal) const {
  const Incidence incidence(direction, normal);
  std::array<double, components.size()> carried{};
  double absorbed = 0.0;
  for (size_t band = 0; band < static_cast<size_t>(bands_); ++band) {
    const PowerFractions fractions = fractions_of(surface_, incidence.cosine, band);
    absorbed += fraction_[band] * fractions.absorbed;
    for (const Component c : components) {
      carried[static_cast<size_t>(c)] += fraction_[band] * fractions.of(c);
    }
  }
  Vec3 kept = direction;
  for (const Component c : components) {
    const double power = carried[static_cast<size_t>(c)];
    if (power > 0.0) kept -= mean_flow(surface_, c, incidence, power);
  }
  const Bsdf& bsdf = *surface_.bsdf;
  const double lit_emission = front_ ? bsdf.front_emission : 1.0 - bsdf.front_emission;
  return kept - bsdf.reemitted * absorbed * (2.0 * lit_emission - 1.0) * lambertian_mean * normal;
}

}  // namespace photorque
