// Glass, rough and wavy mirrors, retroreflectors and heat against closed forms and published
// values.
#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/numerics/quadrature.h"
#include "raytrace/surfaces/cosine_table.h"
#include "raytrace/surfaces/glass.h"
#include "tests/raytrace/bsdf_kinds.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

// Fresnel's sine and tangent laws, which need the angles themselves.
double sine_tangent_reflectance(double angle, double index) {
  const double inside = std::asin(std::sin(angle) / index);
  const double across = std::sin(angle - inside) / std::sin(angle + inside);
  const double within = std::tan(angle - inside) / std::tan(angle + inside);
  return 0.5 * (across * across + within * within);
}

TEST(Fresnel, AgreesWithTheSineAndTangentLaws) {
  for (const double index : {1.1, 1.5, 2.4, 4.0}) {
    for (const double degrees : {1.0, 45.0, 60.0, 80.0, 89.9}) {
      const double angle = degrees * degree_rad;
      EXPECT_NEAR(fresnel_reflectance(std::cos(angle), index),
                  sine_tangent_reflectance(angle, index), 1e-12);
    }
  }
}

// E. Hecht, Optics, 5th ed., section 4.6: 4 % at normal incidence on glass, Brewster's angle 56.3°;
// there only the polarisation across is left, (n² − 1)²/(n² + 1)² of it.
TEST(Fresnel, NormalBrewsterAndGrazingIncidence) {
  EXPECT_NEAR(fresnel_reflectance(1.0, 1.5), 0.04, 1e-15);
  const double brewster = std::atan(1.5);
  EXPECT_NEAR(brewster / degree_rad, 56.3, 0.05);
  EXPECT_NEAR(fresnel_reflectance(std::cos(brewster), 1.5), 0.5 * std::pow(1.25 / 3.25, 2), 1e-15);
  EXPECT_EQ(fresnel_reflectance(0.0, 1.5), 1.0);
  EXPECT_EQ(fresnel_reflectance(0.3, 1.0), 0.0);
}

// Light that comes evenly from everywhere: the integral in closed form (J. W. T. Walsh 1926, as in
// S. Q. Duntley, J. Opt. Soc. Am. 32, 61, 1942); 0.092 for n = 1.5.
TEST(Fresnel, MeanOverTheHemisphere) {
  for (const double n : {1.33, 1.5, 2.0}) {
    const double n2 = n * n, n4 = n2 * n2;
    const double exact =
        0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
        n2 * std::pow(n2 - 1, 2) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
        2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
        8 * n4 * (n4 + 1) / ((n2 + 1) * std::pow(n4 - 1, 2)) * std::log(n);
    EXPECT_NEAR(even_mean([&](double cosine) { return fresnel_reflectance(cosine, n); }), exact,
                1e-8);
    if (n == 1.5) {
      EXPECT_NEAR(exact, 0.092, 5e-4);
    }
  }
}

// A pane without losses passes 2n/(n² + 1) straight on (inner reflections summed).
TEST(Glass, PaneHasTheTextbookTransmittance) {
  for (const double n : {1.33, 1.5, 2.0}) {
    const OpticalSurface pane = behind_glass(grey_surface("s", 0, 0, 1), n);
    EXPECT_NEAR(fractions_of(pane, 1.0, 0).transmitted, 2 * n / (n * n + 1), 1e-14);
    EXPECT_NEAR(pane.transmitted[0], 2 * n / (n * n + 1), 1e-14);
  }
  // Brewster's angle: (1 − r)/(1 + r) of one polarisation would pass and all of the other; the sum
  // of intensities without polarisation is what is modelled.
  const double r = fresnel_reflectance(0.5, 1.5);
  EXPECT_NEAR(fractions_of(behind_glass(grey_surface("s", 0, 0, 1), 1.5), 0.5, 0).transmitted,
              (1 - r) / (1 + r), 1e-14);
}

// The series of inner reflections, summed term by term.
TEST(Glass, InnerReflectionsAreAGeometricSeries) {
  const double index = 1.45, base = 0.3, tau = 0.9;
  const OpticalSurface cell = behind_glass(grey_surface("s", base, 0), index);
  const OpticalSurface pane = behind_glass(grey_surface("s", 0, 0, tau), index);
  for (const double cosine : {0.1, 0.6, 1.0}) {
    const double r = fresnel_reflectance(cosine, index);
    double reflected = r, inside = 1 - r;
    for (int k = 0; k < 200; ++k) {
      reflected += inside * base * (1 - r);
      inside *= base * r;
    }
    EXPECT_NEAR(fractions_of(cell, cosine, 0).specular, reflected, 1e-13);
    const double sine = std::sqrt(1 - cosine * cosine) / index;
    const double once = std::pow(tau, 1 / std::sqrt(1 - sine * sine));
    double up = r, down = 0, beam = 1 - r;
    for (int k = 0; k < 200; ++k) {
      down += beam * once * (1 - r);
      beam *= once * r;
      up += beam * once * (1 - r);
      beam *= once * r;
    }
    EXPECT_NEAR(fractions_of(pane, cosine, 0).specular, up, 1e-13);
    EXPECT_NEAR(fractions_of(pane, cosine, 0).transmitted, down, 1e-13);
  }
}

TEST(Glass, BlackCellBehindItReflectsByFresnelAlone) {
  const OpticalSurface cell = behind_glass(grey_surface("s", 0, 0), 1.5);
  for (const double degrees : {0.5, 45.0, 60.0, 80.0}) {
    const double angle = degrees * degree_rad;
    EXPECT_NEAR(fractions_of(cell, std::cos(angle), 0).absorbed,
                1 - sine_tangent_reflectance(angle, 1.5), 1e-12);
  }
}

// ∫ D G2/(4 μ) do over the outgoing hemisphere: the same albedo through other variables than the
// facets seen.
TEST(Ggx, DirectionalAlbedoAgreesWithAQuadratureOverDirections) {
  for (const double alpha : {0.1, 0.19, 0.5, 1.0}) {
    const Ggx facets{alpha};
    for (const double cosine : {0.1, 0.5, 1.0}) {
      double albedo = 0.0;
      constexpr int panels = 64, around = 1024;
      for (int panel = 0; panel < panels; ++panel) {
        for (const auto& [x, weight] : gauss_legendre(8)) {
          const double root = (panel + 0.5 * (1 + x)) / panels;
          const double z = root * root, sine = std::sqrt(1 - z * z);
          for (int k = 0; k < around; ++k) {
            const double angle = 2 * pi * (k + 0.5) / around;
            albedo +=
                facets.once_reflected_1_sr(direction_at(cosine),
                                           {sine * std::cos(angle), sine * std::sin(angle), z}) *
                2 * root * weight / (2 * panels) * 2 * pi / around;
          }
        }
      }
      EXPECT_NEAR(facets.moments(cosine, [](double) { return 1.0; })[0], albedo, 1e-4)
          << alpha << " " << cosine;
      if (alpha == 1.0 && cosine < 0.2) {  // there is something to test
        EXPECT_LT(albedo, 0.9);
      }
    }
  }
}

// Seen along the normal, facets of alpha = 1 send 1 − ln 2 away at once: ∫ D G1 cos over facets
// that lean by less than 45°, with h_z² as variable.
TEST(Ggx, AlbedoOfTheRoughestSurfaceAlongTheNormal) {
  EXPECT_NEAR(Ggx{1.0}.moments(1.0, [](double) { return 1.0; })[0], 1 - std::log(2.0), 1e-4);
}

// The projected area of the facets is that of the plane: ∫ D h_z dh = 1.
TEST(Ggx, FacetsCoverThePlane) {
  for (const double alpha : {0.1, 0.5, 1.0}) {
    double area = 0.0;
    for (int panel = 0; panel < 64; ++panel) {
      for (const auto& [x, weight] : gauss_legendre(8)) {
        const double slope = std::tan(0.5 * pi * (panel + 0.5 * (1 + x)) / 64);
        const double z = 1 / std::sqrt(1 + slope * slope);
        area += Ggx{alpha}.distribution({std::sqrt(1 - z * z), 0, z}) * z * 2 * pi *
                std::sqrt(1 - z * z) * 0.5 * pi * weight / 128;
      }
    }
    EXPECT_NEAR(area, 1.0, 1e-9);
  }
}

// Slopes s with s² exponential of mean 2σ² turn light by twice their angle: at normal incidence
// <o_z> = <(1 − s²)/(1 + s²)> = 2a e^a E₁(a) − 1 with a = 1/(2σ²).
TEST(SlopeError, MeanDirectionAtNormalIncidence) {
  for (const double sigma : {0.1, 0.15, 0.2}) {
    const double a = 1 / (2 * sigma * sigma);
    const double exact = 2 * a * std::exp(a) * -std::expint(-a) - 1;
    EXPECT_NEAR(slope_error(sigma)->mean_direction(1.0).z(), exact, 1e-6);
    EXPECT_GT(1 - exact, 5e-3);
  }
}

// Slopes of mean zero turn light by terms of the order of σ² = 1e-8 alone, in the mean: it leaves
// along the mirrored direction (−sin θ, 0, cos θ). Near normal incidence too, where the sine
// changes without bound over the cosine. The tail of GGX strays by more.
TEST(SlopeError, MeanDirectionOfSmallSlopesIsTheMirroredOne) {
  constexpr double sigma = 1e-4;
  const auto even = slope_error(sigma);
  const auto turned = slope_error(sigma, 0.5 * sigma, SlopeShape::gaussian);
  const auto rough = rough_mirror(1e-3);
  for (double angle_deg = 0.0; angle_deg < 80.0; angle_deg += 0.37) {
    const double theta = angle_deg * degree_rad;
    const Vec3 mirrored(-std::sin(theta), 0.0, std::cos(theta));
    const Arrival light(std::cos(theta), std::cos(0.7), std::sin(0.7));
    EXPECT_LT((even->mean_direction(light) - mirrored).norm(), 1e-6) << angle_deg;
    EXPECT_LT((turned->mean_direction(light) - mirrored).norm(), 1e-6) << angle_deg;
    EXPECT_LT((rough->mean_direction(light) - mirrored).norm(), 1e-4) << angle_deg;
  }
}

// A reflected ray strays by 2σ along and across the plane of incidence (here from 40°).
TEST(SlopeError, RaysDeviateByTwiceTheSlope) {
  const double sigma = 0.003, cosine = std::cos(40 * degree_rad);
  const auto lobe = slope_error(sigma);
  double across = 0, along = 0;
  constexpr int rays = 1 << 16;
  for (uint64_t i = 0; i < rays; ++i) {
    const Vec3 out = lobe->direction(cosine, fixtures::random_draw(i));
    across += std::pow(out.y(), 2) / rays;
    along += std::pow(std::atan2(-out.x(), out.z()) - 40 * degree_rad, 2) / rays;
  }
  // Across, the lean acts by 2σ cos θ on a ray at θ. 1.5 %: five standard errors.
  EXPECT_NEAR(std::sqrt(along), 2 * sigma, 0.015 * 2 * sigma);
  EXPECT_NEAR(std::sqrt(across), 2 * sigma * cosine, 0.015 * 2 * sigma);
}

// The force of parallel light of pressure 1 Pa on a scene [m²].
Vec3 force_of(Scene scene, const Vec3& light) {
  const double size = 2.02 * scene.radius_m();
  const TraceableScene traceable(std::move(scene));
  const auto emitter =
      std::make_shared<fixtures::ParallelBeam>(speed_of_light_m_s * size * size, size);
  const Beam beam = fixtures::beam(emitter, -5 * size * light, light);
  const fixtures::TotalWrench wrench;
  const Receiver* const receivers[] = {&wrench};
  const TraceResult result =
      trace(traceable, {}, std::span(&beam, 1), receivers, {.rays = 1 << 17});
  Vec3 force;
  for (size_t k = 0; k < 3; ++k) {
    force[static_cast<Eigen::Index>(k)] = result.sums[0].estimate(k).value;
    EXPECT_NEAR(result.sums[0].estimate(k).value, result.power_balance.force_N[k].value,
                5 * result.power_balance.force_N[k].standard_error + 1e-6 * size * size);
  }
  return force;
}

Scene sphere_of(const OpticalSurface& surface) {
  return fixtures::scene_of_part(fixtures::sphere(1.0, 160), surface, "sphere");
}
// Its shadow.
const double disc = 160 * std::sin(pi / 160);

// A sphere of Lambertian facets under glass of index 1 is one without glass: πR² (1 + 4/9).
TEST(FacetSphere, LambertianThroughAnyPath) {
  const double exact = -disc * (1 + 4.0 / 9.0);
  EXPECT_NEAR(force_of(sphere_of(grey_surface("s", 0, 1)), {0, 0, -1}).z(), exact, 1e-3 * disc);
  EXPECT_NEAR(force_of(sphere_of(behind_glass(grey_surface("s", 0, 1), 1.0)), {0, 0, -1}).z(),
              exact, 1e-3 * disc);
}

// Light that goes back where it came from pushes twice, on any shape: πR² (1 + ρ).
TEST(FacetSphere, RetroreflectorPushesTwice) {
  EXPECT_NEAR(force_of(sphere_of(fixtures::retroreflector(0.7, 0)), {0, 0, -1}).z(), -1.7 * disc,
              1e-4 * disc);
}

// A black sphere in glass: mirrored light of reflectance R(θ) adds −∫ R cos 2θ dA_shadow, here with
// Fresnel's law by another quadrature.
TEST(FacetSphere, GlassOverBlack) {
  double mirrored = 0.0;
  for (const auto& [x, weight] : gauss_legendre(64)) {
    const double angle = 0.25 * pi * (1 + x);
    mirrored += 0.25 * pi * weight * sine_tangent_reflectance(angle, 1.5) * std::cos(2 * angle) *
                std::sin(2 * angle);
  }
  EXPECT_GT(std::abs(mirrored), 5e-3);
  EXPECT_NEAR(force_of(sphere_of(behind_glass(grey_surface("s", 0, 0), 1.5)), {0, 0, -1}).z(),
              -disc * (1 + mirrored), 1e-3 * disc);
}

OpticalSurface hot(OpticalSurface surface, double reemitted, double front_emission) {
  Bsdf bsdf = surface.bsdf ? *surface.bsdf : Bsdf{};
  bsdf.reemitted = reemitted;
  bsdf.front_emission = front_emission;
  surface.bsdf = std::make_shared<const Bsdf>(bsdf);
  return surface;
}

Scene plate_of(const OpticalSurface& surface) {
  return fixtures::scene_of_part(fixtures::rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 1, 0)),
                                 surface, "plate");
}

// F = A cos θ [d − (2/3) α r (ε_f − ε_b)/(ε_f + ε_b) n_f + reflections]: a black plate that sends
// everything back as heat from its lit side is pushed like a white one.
TEST(Heat, PushesByLambertsLawFromEachSide) {
  const double angle = 30 * degree_rad, c = std::cos(angle);
  for (const double side : {1.0, -1.0}) {
    const Vec3 light(-std::sin(angle), 0, -side * c);
    for (const auto& [fraction, front] :
         {std::pair{1.0, 1.0}, {0.6, 0.75}, {1.0, 0.5}, {1.0, 0.0}}) {
      const double net = fraction * (2 * front - 1);
      const Vec3 exact = 2 * c * (light - 2.0 / 3.0 * net * Vec3::UnitZ());
      const Vec3 black = force_of(plate_of(hot(grey_surface("s", 0, 0), fraction, front)), light);
      EXPECT_LT((black - exact).norm(), 1e-3) << side << " " << fraction << " " << front;
      const Vec3 mixed = force_of(plate_of(hot(grey_surface("s", 0.4, 0), fraction, front)), light);
      const Vec3 mirrored(light.x(), 0, -light.z());
      EXPECT_LT((mixed - (exact - 2 * c * (0.4 * mirrored - 0.4 * 2.0 / 3.0 * net * Vec3::UnitZ())))
                    .norm(),
                1e-3);
    }
  }
  const Vec3 down(0, 0, -1);
  EXPECT_LT((force_of(plate_of(hot(grey_surface("s", 0, 0), 1, 1)), down) -
             force_of(plate_of(grey_surface("s", 0, 1)), down))
                .norm(),
            1e-3);
}

}  // namespace
}  // namespace photorque
