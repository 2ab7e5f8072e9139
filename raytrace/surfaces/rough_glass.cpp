#include "raytrace/surfaces/rough_glass.h"

#include "raytrace/surfaces/fresnel.h"

namespace photorque {

RoughGlass::RoughGlass(double alpha, double index)
    : facets_{alpha}, index_(index), once_([this](double cosine) {
        return facets_.moments(
            cosine, [this](double facing) { return fresnel_reflectance(facing, index_); });
      }) {}

Vec3 RoughGlass::direction(double cosine, const Draw& draw) const {
  const Vec3 in = direction_at(cosine);
  Vec3 out = Vec3::UnitZ();
  // Glass reflects one ray in some 25 at a steep angle: as many attempts are the rule, this many
  // never happen.
  constexpr uint64_t most = 4096;
  for (uint64_t attempt = 0; attempt < most; ++attempt) {
    const Draw now = draw.attempt(attempt);
    const Vec3 normal = facets_.visible_normal(in, now.u, now.v);
    const double facing = in.dot(normal);
    out = 2.0 * facing * normal - in;
    const double kept = facets_.leaves(cosine, out.z());
    if (kept > 0.0 && draw.extra(3 * attempt + 2) < kept * fresnel_reflectance(facing, index_)) {
      return out;
    }
  }
  out.z() = std::max(1e-6, std::abs(out.z()));
  return out.normalized();
}

Vec3 RoughGlass::mean_direction(double cosine) const {
  const auto [power, x, z] = once_(cosine);
  return {x / power, 0.0, z / power};
}

double RoughGlass::density(double cosine, const Vec3& out) const {
  const Vec3 in = direction_at(cosine);
  const double facing = in.dot((in + out).normalized());
  return facets_.once_reflected_1_sr(in, out) * fresnel_reflectance(facing, index_) /
         reflectance(cosine);
}

std::shared_ptr<const RoughGlass> rough_glass(double alpha, double index) {
  return std::make_shared<RoughGlass>(alpha, index);
}

}  // namespace photorque
