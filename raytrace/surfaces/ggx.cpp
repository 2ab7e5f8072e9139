#include "raytrace/surfaces/ggx.h"

#include <cmath>

#include "core/constants.h"
#include "core/numerics/quadrature.h"

namespace photorque {

Vec3 direction_at(double cosine) {
  return {std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), 0.0, cosine};
}

double Ggx::lambda(double cosine) const {
  const double cosine2 = cosine * cosine;
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * (1.0 - cosine2) / cosine2) - 1.0);
}

double Ggx::distribution(const Vec3& normal) const {
  const double alpha2 = alpha * alpha;
  const double spread = normal.z() * normal.z() * (alpha2 - 1.0) + 1.0;
  return alpha2 / (pi * spread * spread);
}

Vec3 Ggx::visible_normal(const Vec3& towards_light, double u, double v) const {
  // Scale the frame: the facets become those of a hemisphere, seen as a disc that is cut along
  // its middle.
  const Vec3 seen =
      Vec3(alpha * towards_light.x(), alpha * towards_light.y(), towards_light.z()).normalized();
  const double across = std::hypot(seen.x(), seen.y());
  const Vec3 side = across > 0.0 ? Vec3(-seen.y() / across, seen.x() / across, 0.0) : Vec3::UnitX();
  const Vec3 up = seen.cross(side);
  const double radius = std::sqrt(u), angle = 2.0 * pi * v;
  const double a = radius * std::cos(angle), squeeze = 0.5 * (1.0 + seen.z());
  const double b = (1.0 - squeeze) * std::sqrt(1.0 - a * a) + squeeze * radius * std::sin(angle);
  const Vec3 normal = a * side + b * up + std::sqrt(std::max(0.0, 1.0 - a * a - b * b)) * seen;
  return Vec3(alpha * normal.x(), alpha * normal.y(), std::max(1e-12, normal.z())).normalized();
}

double Ggx::leaves(double cosine_in, double cosine_out) const {
  if (!(cosine_out > 0.0)) return 0.0;
  const double in = 1.0 + lambda(cosine_in);
  return in / (in + lambda(cosine_out));
}

double Ggx::once_reflected_1_sr(const Vec3& towards_light, const Vec3& out) const {
  const Vec3 normal = (towards_light + out).normalized();
  return distribution(normal) /
         (4.0 * towards_light.z() * (1.0 + lambda(towards_light.z()) + lambda(out.z())));
}

Ggx::Moments Ggx::moments(double cosine, const std::function<double(double)>& of_facet) const {
  // Steep facets lie at the rim of the disc of visible facets and form a long tail, so each panel
  // has half the width of the one before. Rough surfaces, where many facets reflect below the
  // horizon, have a kink there and need more points.
  constexpr size_t panels = 11, angles = 48;
  const size_t radii = alpha < 0.2 ? 8 : 24;
  const Vec3 in = direction_at(cosine);
  Moments sum{};
  double low = 0.0;
  for (size_t panel = 0; panel < panels; ++panel) {
    const double width = panel + 1 < panels ? 0.5 * (1.0 - low) : 1.0 - low;
    for (const auto& [x, weight] : gauss_legendre(radii)) {
      const double radius = low + 0.5 * width * (1.0 + x);  // u = radius²
      for (size_t k = 0; k < angles; ++k) {
        const double turn = (static_cast<double>(k) + 0.5) / angles;
        const Vec3 normal = visible_normal(in, radius * radius, turn);
        const double facing = in.dot(normal);
        const Vec3 out = 2.0 * facing * normal - in;
        const double power =
            weight * width * radius / angles * leaves(cosine, out.z()) * of_facet(facing);
        sum[0] += power;
        sum[1] += power * out.x();
        sum[2] += power * out.z();
      }
    }
    low += width;
  }
  sum[1] /= in.x();
  return sum;
}

}  // namespace photorque
