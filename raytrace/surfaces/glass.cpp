#include "raytrace/surfaces/glass.h"

#include <cmath>
#include <sstream>

#include "core/constants.h"
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
  RoughGlass(double alpha, double index);

  // E at `cosine`, from a table with an error of 1e-4.
  double reflectance(double cosine) const { return once_(cosine)[0]; }

  Vec3 direction(const Arrival& light, const Draw& draw) const override;
  Vec3 mean_direction(const Arrival& light) const override;
  double density(const Arrival& light, const Vec3& out) const override;

 private:
  Ggx facets_;
  double index_;
  CosineTable<3> once_;  // power, sums of o_x over sin θ and of o_z
};

RoughGlass::RoughGlass(double alpha, double index)
    : facets_{alpha}, index_(index), once_([this](double cosine) {
        return facets_.moments(
            cosine, [this](double facing) { return fresnel_reflectance(facing, index_); });
      }) {}

Vec3 RoughGlass::direction(const Arrival& light, const Draw& draw) const {
  const double cosine = light.cosine;
  const Vec3 in = direction_at(cosine);
  Vec3 out = Vec3::UnitZ();
  // At a steep angle glass reflects about one ray in 25, so about 25 attempts are typical. The
  // limit is never reached in practice.
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

Vec3 RoughGlass::mean_direction(const Arrival& light) const {
  const double cosine = light.cosine;
  const auto [power, x_by_sine, z] = once_(cosine);
  return {direction_at(cosine).x() * x_by_sine / power, 0.0, z / power};
}

double RoughGlass::density(const Arrival& light, const Vec3& out) const {
  const double cosine = light.cosine;
  const Vec3 in = direction_at(cosine);
  const double facing = in.dot((in + out).normalized());
  return facets_.once_reflected_1_sr(in, out) * fresnel_reflectance(facing, index_) /
         reflectance(cosine);
}

using Reflectance = std::function<double(double cosine)>;

class OverMatt final : public AlbedoLaw {
 public:
  OverMatt(const BandValues& diffuse, Reflectance front)
      : diffuse_(diffuse), front_(std::move(front)) {}
  PowerFractions fractions(double cosine, size_t band) const override {
    const double reflected = front_(cosine), enters = 1.0 - reflected;
    return {.absorbed = enters * (1.0 - diffuse_[band]),
            .specular = reflected,
            .diffuse = enters * diffuse_[band]};
  }

 private:
  BandValues diffuse_;
  Reflectance front_;
};

class OverCell final : public AlbedoLaw {
 public:
  OverCell(const BandValues& specular, Reflectance front)
      : specular_(specular), front_(std::move(front)) {}
  PowerFractions fractions(double cosine, size_t band) const override {
    const double reflected = front_(cosine), enters = 1.0 - reflected;
    const double base = specular_[band];
    // Light that meets the base, including inner reflections, as a fraction of the incident light.
    // None enters at grazing incidence.
    const double meets = enters > 0.0 ? enters / (1.0 - reflected * base) : 0.0;
    return {.absorbed = meets * (1.0 - base), .specular = 1.0 - meets * (1.0 - base)};
  }

 private:
  BandValues specular_;
  Reflectance front_;
};

class Pane final : public AlbedoLaw {
 public:
  Pane(const BandValues& transmitted, double index) : transmitted_(transmitted), index_(index) {}
  PowerFractions fractions(double cosine, size_t band) const override {
    const double face = fresnel_reflectance(cosine, index_), enters = 1.0 - face;
    const double once = std::pow(transmitted_[band], 1.0 / refracted_cosine(cosine, index_));
    const double there_and_back = face * once;
    const double leaves =
        enters > 0.0 ? enters * enters * once / (1.0 - there_and_back * there_and_back) : 0.0;
    PowerFractions fractions{.specular = face + there_and_back * leaves, .transmitted = leaves};
    fractions.absorbed = std::max(0.0, 1.0 - fractions.specular - fractions.transmitted);
    return fractions;
  }

 private:
  BandValues transmitted_;
  double index_;
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
  std::ostringstream text;
  text.precision(3);
  text << (alpha > 0.0 ? "rough " : "") << "glass of index " << index << " in front";
  if (alpha > 0.0) text << ", roughness " << std::sqrt(alpha);
  return text.str();
}

}  // namespace

GlassBase glass_base(const OpticalSurface& base) {
  const auto some = [](const BandValues& values) {
    return std::any_of(values.begin(), values.end(), [](double value) { return value > 0.0; });
  };
  if (some(base.transmitted)) return GlassBase::pane;
  return some(base.specular) ? GlassBase::cell : GlassBase::matt;
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
      bsdf.law = std::make_shared<OverMatt>(base.diffuse, front);
      bsdf.diffuse = std::make_shared<ThroughFront>(front);
      break;
    case GlassBase::cell:
      bsdf.law = std::make_shared<OverCell>(base.specular, front);
      break;
    case GlassBase::pane:
      bsdf.law = std::make_shared<Pane>(base.transmitted, index);
      break;
  }
  bsdf.description = describe(index, alpha);
  OpticalSurface surface = base;
  for (size_t band = 0; band < max_bands; ++band) {
    const double sum =
        base.absorbed[band] + base.specular[band] + base.diffuse[band] + base.transmitted[band];
    if (sum == 0.0) continue;  // band not in use
    const PowerFractions fractions = bsdf.law->fractions(1.0, band);
    surface.absorbed[band] = fractions.absorbed;
    surface.specular[band] = fractions.specular;
    surface.diffuse[band] = fractions.diffuse;
    surface.transmitted[band] = fractions.transmitted;
  }
  surface.bsdf = std::make_shared<const Bsdf>(std::move(bsdf));
  return surface;
}

}  // namespace photorque
