#include "raytrace/surfaces/glass.h"

#include <cmath>

#include "core/constants.h"
#include "core/text/format.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/surfaces/cosine_table.h"
#include "raytrace/surfaces/ggx.h"

namespace photorque {

double refracted_cosine(double cosine, double index) {
  return std::sqrt(1.0 - (1.0 - cosine * cosine) / (index * index));
}

double fresnel_reflectance(double cosine, double index) {
  if (index == 1.0) return 0.0;  // also at grazing incidence
  const double inside = refracted_cosine(cosine, index);
  const double across = (cosine - index * inside) / (cosine + index * inside);
  const double within = (index * cosine - inside) / (index * cosine + inside);
  return 0.5 * (across * across + within * within);
}

namespace {

// The rough front of a clear dielectric: GGX microfacets that reflect by Fresnel's law.
//
// The lobe is the light that leaves after one reflection, of power E(μ) = ∫ F(i·h) D G2/(4 μ) do.
// It is reciprocal. The remaining light counts as entering the glass, so no power is lost.
class RoughGlass final : public Lobe {
 public:
  // `alpha` ∈ [0.001, 1], `index` ∈ (1, 10].
  RoughGlass(double alpha, double index)
      : facets_{alpha}, index_(index), once_([this](double cosine) {
          return facets_.moments(
              cosine, [this](double facing) { return fresnel_reflectance(facing, index_); });
        }) {}

  // E at `cosine`, from a table with an error of 1e-4.
  double reflectance(double cosine) const { return once_(cosine)[0]; }

  Vec3 direction(const Arrival& light, const Draw& draw) const override {
    const Vec3 in = direction_at(light.cosine);
    Vec3 out = Vec3::UnitZ();
    // At a steep angle glass reflects about one ray in 25, so about 25 attempts are typical. The
    // limit is never reached in practice.
    constexpr uint64_t most = 4096;
    for (uint64_t attempt = 0; attempt < most; ++attempt) {
      const Draw now = draw.attempt(attempt);
      const Vec3 normal = facets_.visible_normal(in, now.u, now.v);
      const double facing = in.dot(normal);
      out = 2.0 * facing * normal - in;
      const double kept = facets_.leaves(light.cosine, out.z());
      if (kept > 0.0 && draw.extra(3 * attempt + 2) < kept * fresnel_reflectance(facing, index_)) {
        return out;
      }
    }
    out.z() = std::max(1e-6, std::abs(out.z()));
    return out.normalized();
  }

  Vec3 mean_direction(const Arrival& light) const override {
    const auto [power, x_by_sine, z] = once_(light.cosine);
    return {direction_at(light.cosine).x() * x_by_sine / power, 0.0, z / power};
  }

  double density(const Arrival& light, const Vec3& out) const override {
    const Vec3 in = direction_at(light.cosine);
    const double facing = in.dot((in + out).normalized());
    return facets_.once_reflected_1_sr(in, out) * fresnel_reflectance(facing, index_) /
           reflectance(light.cosine);
  }

 private:
  Ggx facets_;
  double index_;
  CosineTable<3> once_;  // power, sums of o_x over sin θ and of o_z
};

using Reflectance = std::function<double(double cosine)>;

// The fractions behind a front that reflects the fraction `reflected`, for a matt base that
// scatters `diffuse` and for a cell that reflects `specular`.
PowerFractions over_matt(double reflected, double diffuse) {
  const double enters = 1.0 - reflected;
  return {.absorbed = enters * (1.0 - diffuse), .specular = reflected, .diffuse = enters * diffuse};
}

PowerFractions over_cell(double reflected, double specular) {
  const double enters = 1.0 - reflected;
  // Light that meets the base, including inner reflections, as a fraction of the incident light.
  // None enters at grazing incidence.
  const double meets = enters > 0.0 ? enters / (1.0 - reflected * specular) : 0.0;
  return {.absorbed = meets * (1.0 - specular), .specular = 1.0 - meets * (1.0 - specular)};
}

PowerFractions of_pane(double cosine, double index, double transmitted) {
  const double face = fresnel_reflectance(cosine, index), enters = 1.0 - face;
  const double once = std::pow(transmitted, 1.0 / refracted_cosine(cosine, index));
  const double there_and_back = face * once;
  const double leaves =
      enters > 0.0 ? enters * enters * once / (1.0 - there_and_back * there_and_back) : 0.0;
  PowerFractions fractions{.specular = face + there_and_back * leaves, .transmitted = leaves};
  fractions.absorbed = std::max(0.0, 1.0 - fractions.specular - fractions.transmitted);
  return fractions;
}

// The fractions of a base with one property per band, behind glass.
class GlassLaw final : public AlbedoLaw {
 public:
  using Fractions = std::function<PowerFractions(double cosine, double base)>;
  GlassLaw(const BandValues& base, Fractions fractions)
      : base_(base), fractions_(std::move(fractions)) {}
  PowerFractions fractions(double cosine, size_t band) const override {
    return fractions_(cosine, base_[band]);
  }

 private:
  BandValues base_;
  Fractions fractions_;
};

// Light of a Lambertian base after its passage through the glass.
class ThroughFront final : public Lobe {
 public:
  explicit ThroughFront(Reflectance front)
      : front_(std::move(front)),
        passed_(even_mean([this](double cosine) { return 1.0 - front_(cosine); })),
        mean_z_(even_mean([this](double cosine) { return cosine * (1.0 - front_(cosine)); }) /
                passed_) {}

  Vec3 direction(const Arrival&, const Draw& draw) const override {
    Vec3 out = lambertian_direction(draw.u, draw.v);
    constexpr uint64_t most = 256;
    for (uint64_t attempt = 1; attempt < most; ++attempt) {
      if (draw.extra(3 * attempt + 2) >= front_(out.z())) break;
      const Draw now = draw.attempt(attempt);
      out = lambertian_direction(now.u, now.v);
    }
    return out;
  }

  Vec3 mean_direction(const Arrival&) const override { return {0.0, 0.0, mean_z_}; }

  double density(const Arrival&, const Vec3& out) const override {
    return (1.0 - front_(out.z())) * out.z() / (pi * passed_);
  }

 private:
  Reflectance front_;
  double passed_;  // 1 − R̄
  double mean_z_;
};

std::string describe(double index, double alpha) {
  if (!(alpha > 0.0)) return printed("glass of index %.3g in front", index);
  return printed("rough glass of index %.3g in front, roughness %.3g", index, std::sqrt(alpha));
}

}  // namespace

GlassBase glass_base(const OpticalSurface& base) {
  if (any_positive(base.transmitted)) return GlassBase::pane;
  return any_positive(base.specular) ? GlassBase::cell : GlassBase::matt;
}

OpticalSurface behind_glass(const OpticalSurface& base, double index, double alpha) {
  Bsdf bsdf = base.bsdf ? *base.bsdf : Bsdf{};
  Reflectance front = [index](double cosine) { return fresnel_reflectance(cosine, index); };
  if (alpha > 0.0) {
    const std::shared_ptr<const RoughGlass> rough = std::make_shared<RoughGlass>(alpha, index);
    front = [rough](double cosine) { return rough->reflectance(cosine); };
    bsdf.specular = rough;
  }
  switch (glass_base(base)) {
    case GlassBase::matt:
      bsdf.law = std::make_shared<GlassLaw>(base.diffuse, [front](double cosine, double diffuse) {
        return over_matt(front(cosine), diffuse);
      });
      bsdf.diffuse = std::make_shared<ThroughFront>(front);
      break;
    case GlassBase::cell:
      bsdf.law = std::make_shared<GlassLaw>(base.specular, [front](double cosine, double specular) {
        return over_cell(front(cosine), specular);
      });
      break;
    case GlassBase::pane:
      bsdf.law =
          std::make_shared<GlassLaw>(base.transmitted, [index](double cosine, double transmitted) {
            return of_pane(cosine, index, transmitted);
          });
      break;
  }
  bsdf.description = describe(index, alpha);
  OpticalSurface surface = base;
  for (size_t band = 0; band < max_bands; ++band) {
    const double sum =
        base.absorbed[band] + base.specular[band] + base.diffuse[band] + base.transmitted[band];
    if (sum == 0.0) continue;  // band not in use
    set_fractions(surface, band, bsdf.law->fractions(1.0, band));
  }
  surface.bsdf = std::make_shared<const Bsdf>(std::move(bsdf));
  return surface;
}

}  // namespace photorque
