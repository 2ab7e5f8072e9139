// Laws that every surface obeys.
#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/numerics/quadrature.h"
#include "tests/raytrace/bsdf_kinds.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

using fixtures::first_moment;
using fixtures::random_draw;
using fixtures::scattering_1_sr;
using fixtures::send_ray;
using fixtures::surface_kinds;
using fixtures::SurfaceKind;

constexpr double cosines[] = {0.05, 0.2, 0.5, 0.8, 1.0};

TEST(SurfaceLaws, AbsorptancePlusReflectanceIsOneAtEveryAngle) {
  for (const double kept : {0.0, 0.3, 1.0}) {
    for (const SurfaceKind& kind : surface_kinds(kept)) {
      for (const double cosine : {1e-9, 1e-3, 0.1, 0.37, 0.9, 1.0}) {
        const PowerFractions s = fractions_of(kind.surface, cosine, 0);
        EXPECT_NEAR(s.absorbed + s.specular + s.diffuse + s.transmitted + s.retroreflected, 1.0,
                    1e-12)
            << kind.name << " " << cosine;
        EXPECT_GE(std::min({s.absorbed, s.specular, s.diffuse, s.transmitted, s.retroreflected}),
                  -1e-15)
            << kind.name << " " << cosine;
        if (kept == 1.0) {
          EXPECT_NEAR(s.absorbed, 0.0, 1e-12) << kind.name << " " << cosine;
        }
      }
    }
  }
}

// χ² of the directions that leave a surface on which light falls evenly from everywhere, in 16
// classes that are equally likely where the surface is indistinguishable from its surroundings.
template <typename Send>
double furnace_chi2(const Send& send) {
  constexpr int rays = 1 << 18, classes = 16;
  std::array<double, classes> counted{};
  for (int i = 0; i < rays; ++i) {
    const auto index = static_cast<uint64_t>(i);
    const double cosine = std::sqrt((i + unit_interval(hash_words(index, 7))) / rays);
    const Vec3 out = send(cosine, random_draw(index));
    const auto at = static_cast<size_t>(classes * out.z() * out.z());
    counted[std::min<size_t>(at, classes - 1)] += out.squaredNorm() > 0.5 ? 1.0 : 0.0;
  }
  double chi2 = 0.0;
  for (const double count : counted) {
    const double expected = static_cast<double>(rays) / classes;
    chi2 += (count - expected) * (count - expected) / expected;
  }
  return chi2;
}

// 16 degrees of freedom (the total is free): 99.99 % are below 45. Over the kinds none is expected
// above.
constexpr double white_chi2 = 45.0;

TEST(SurfaceLaws, NothingShowsInAWhiteFurnace) {
  for (const SurfaceKind& kind : surface_kinds(1.0)) {
    // Light of one azimuth is no furnace for a surface with an axis: slope_error_test.cpp.
    if (kind.surface.bsdf && !kind.surface.bsdf->axis.isZero()) continue;
    EXPECT_LT(furnace_chi2([&](double cosine, const Draw& draw) {
                return send_ray(kind.surface, cosine, draw);
              }),
              white_chi2)
        << kind.name;
  }
}

// Mutants that the furnace must find: a lobe that is not reciprocal, one that forgets light
// reflected more than once, and a surface that keeps a hundredth.
TEST(SurfaceLaws, TheFurnaceFindsMutants) {
  const auto even_in_solid_angle = [](double, const Draw& draw) {
    const double radius = std::sqrt(1 - draw.u * draw.u);
    return Vec3(radius * std::cos(2 * pi * draw.v), radius * std::sin(2 * pi * draw.v), draw.u);
  };
  const Ggx facets{1.0};
  const auto once = [&](double cosine, const Draw& draw) {
    const Vec3 in = direction_at(cosine);
    for (uint64_t attempt = 0;; ++attempt) {
      const Draw now = draw.attempt(attempt);
      const Vec3 normal = facets.visible_normal(in, now.u, now.v);
      const Vec3 out = 2 * in.dot(normal) * normal - in;
      if (draw.extra(3 * attempt + 2) < facets.leaves(cosine, out.z())) return out;
    }
  };
  const OpticalSurface grey = grey_surface("grey", 0.0, 0.98);
  EXPECT_GT(furnace_chi2(even_in_solid_angle), 2 * white_chi2);
  EXPECT_GT(furnace_chi2(once), 2 * white_chi2);
  EXPECT_GT(
      furnace_chi2([&](double cosine, const Draw& draw) { return send_ray(grey, cosine, draw); }),
      2 * white_chi2);
}

TEST(SurfaceLaws, ScatteringIsReciprocal) {
  for (const SurfaceKind& kind : surface_kinds(0.6)) {
    // Turned directions would need a turned axis: tests/raytrace/slope_error_test.cpp.
    if (kind.surface.bsdf && !kind.surface.bsdf->axis.isZero()) continue;
    // Slope errors are reciprocal where no part of the surface is seen from behind.
    const double lowest = kind.name.starts_with("slope") ? 0.35 : 0.03;
    double largest = 0.0;
    for (uint64_t i = 0; i < 2000; ++i) {
      const Draw draw = random_draw(i);
      const double cosine = lowest + (1 - lowest) * draw.extra(1);
      // Directions where the lobe has weight, and others.
      const Vec3 sent = i % 2 == 0 ? Vec3(lambertian_direction(draw.u, draw.v))
                                   : send_ray(kind.surface, cosine, draw);
      if (sent.z() < lowest) continue;
      const double there = scattering_1_sr(kind.surface, cosine, sent, 0);
      // The pair of directions, turned so that the light comes from `sent`.
      const double sine = std::sqrt(1 - cosine * cosine), out_sine = std::hypot(sent.x(), sent.y());
      const double along = out_sine > 0 ? sent.x() / out_sine : 1.0;
      const Vec3 back(sine * along, sine * std::sqrt(std::max(0.0, 1 - along * along)), cosine);
      const double again = scattering_1_sr(kind.surface, sent.z(), back, 0);
      if (there > 1e-6) largest = std::max(largest, std::abs(there / again - 1));
    }
    EXPECT_LT(largest, 2e-4) << kind.name;
  }
}

// ∫ f cos do over the hemisphere, the directional reflectance, and the first moment, by a
// quadrature that is independent of the surface.
TEST(SurfaceLaws, ScatteringSumsToTheFractionsAndTheFirstMoment) {
  for (const SurfaceKind& kind : surface_kinds(0.6)) {
    if (!kind.smooth) continue;
    for (const double cosine : cosines) {
      double power = 0.0;
      Vec3 mean = Vec3::Zero();
      constexpr int panels = 24, around = 512;
      for (int panel = 0; panel < panels; ++panel) {
        for (const auto& [x, weight] : gauss_legendre(8)) {
          const double root = (panel + 0.5 * (1 + x)) / panels;  // of the cosine
          const double z = root * root, sine = std::sqrt(1 - z * z);
          for (int k = 0; k < around; ++k) {
            const double angle = 2 * pi * (k + 0.5) / around;
            const Vec3 out(sine * std::cos(angle), sine * std::sin(angle), z);
            const double fraction = scattering_1_sr(kind.surface, cosine, out, 0) * z * 2 * root *
                                    weight / (2 * panels) * 2 * pi / around;
            power += fraction;
            mean += fraction * out;
          }
        }
      }
      const PowerFractions fractions = fractions_of(kind.surface, cosine, 0);
      const Bsdf* bsdf = kind.surface.bsdf.get();
      const bool lobe = bsdf != nullptr && bsdf->specular;
      const double scattered = fractions.diffuse + (lobe ? fractions.specular : 0.0);
      EXPECT_NEAR(power, scattered, 2e-4) << kind.name << " " << cosine;
      const Vec3 in = direction_at(cosine), mirrored(-in.x(), 0, in.z());
      const Vec3 expected = mean + (lobe ? 0.0 : fractions.specular) * mirrored +
                            (fractions.retroreflected - fractions.transmitted) * in;
      EXPECT_LT((first_moment(kind.surface, cosine, 0) - expected).norm(), 2e-4)
          << kind.name << " " << cosine;
    }
  }
}

TEST(SurfaceLaws, RaysCarryTheMeanDepartureAway) {
  constexpr int rays = 1 << 16;
  for (const SurfaceKind& kind : surface_kinds(0.8)) {
    for (const double cosine : cosines) {
      const PowerFractions fractions = fractions_of(kind.surface, cosine, 0);
      Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
      for (uint64_t i = 0; i < rays; ++i) {
        const Vec3 out = send_ray(kind.surface, cosine, random_draw(i));
        EXPECT_TRUE(out.isZero() || std::abs(out.norm() - 1) < 1e-6);
        sum += out;
        squares += out.cwiseProduct(out);
      }
      const Vec3 mean = sum / rays;
      const Vec3 error =
          ((squares / rays - mean.cwiseProduct(mean)) / rays).cwiseMax(0).cwiseSqrt();
      // send_ray() lets transmitted light go up.
      const Vec3 exact =
          first_moment(kind.surface, cosine, 0) + 2 * fractions.transmitted * direction_at(cosine);
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT(std::abs(mean[k] - exact[k]), 4.5 * error[k] + 5e-5)
            << kind.name << " " << cosine << " axis " << k;
      }
    }
  }
}

// A slanted plate of every kind in parallel light: what it absorbs is its fraction at that angle,
// all emitted power is accounted for, and the force on the surface is what the rays lost.
TEST(SurfaceLaws, PowerAndMomentumBalanceAtEveryBounce) {
  for (const SurfaceKind& kind : surface_kinds(0.7)) {
    for (const double cosine : {1.0, 0.3}) {
      const TraceableScene traceable(fixtures::scene_of_part(
          fixtures::rectangle(Vec3::Zero(), Vec3(4, 0, 0), Vec3(0, 4, 0)), kind.surface, "plate"));
      const double sine = std::sqrt(1 - cosine * cosine);
      const Vec3 light(-sine, 0, -cosine);
      const Beam beam =
          fixtures::beam(std::make_shared<fixtures::ParallelBeam>(2.0, 0.5), -2 * light, light);
      const fixtures::TotalWrench wrench;
      const Receiver* const receivers[] = {&wrench};
      const TraceResult result =
          trace(traceable, {}, std::span(&beam, 1), receivers, {.rays = 1 << 16});
      const PowerBalance& power_balance = result.power_balance;
      EXPECT_LE(power_balance.closure, 1e-12) << kind.name;
      EXPECT_NEAR(power_balance.absorbed_W.value,
                  2 * fractions_of(kind.surface, cosine, 0).absorbed, 1e-6)
          << kind.name << " " << cosine;
      const Vec3 exact = 2 / speed_of_light_m_s * (light - first_moment(kind.surface, cosine, 0));
      for (size_t k = 0; k < 3; ++k) {
        const Estimate force = result.sums[0].estimate(k);
        const Estimate& by_rays = power_balance.force_N[k];
        const double newton = 2 / speed_of_light_m_s;
        EXPECT_NEAR(force.value, exact[static_cast<Eigen::Index>(k)], 3e-7 * newton)
            << kind.name << " " << cosine;
        EXPECT_LT(std::abs(force.value - by_rays.value),
                  4.5 * std::hypot(force.standard_error, by_rays.standard_error) + 1e-4 * newton)
            << kind.name << " " << cosine;
      }
    }
  }
}

}  // namespace
}  // namespace photorque
