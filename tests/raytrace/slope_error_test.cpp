// Slope errors of mirrors: their distributions, along axes that the surface has itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "tests/raytrace/bsdf_kinds.h"

namespace photorque {
namespace {

using fixtures::random_draw;

// The slope of the normal that sends light from the normal along `out`.
Vec2 slope_of(const Vec3& out) {
  const Vec3 normal = (Vec3::UnitZ() + out).normalized();
  return Vec2(normal.x(), normal.y()) / normal.z();
}

constexpr int rays = 1 << 18, classes = 16;

// χ² of the fractions of slopes within rings that should hold a sixteenth each; `within` is the
// cumulative distribution of the slope's size.
template <typename Within>
double rings_chi2(const Lobe& lobe, const Within& within) {
  std::array<double, classes> counted{};
  for (uint64_t i = 0; i < rays; ++i) {
    const double part = within(slope_of(lobe.direction(1.0, random_draw(i))).norm());
    counted[std::min<size_t>(static_cast<size_t>(classes * part), classes - 1)] += 1.0;
  }
  double chi2 = 0.0;
  for (const double count : counted) {
    const double expected = static_cast<double>(rays) / classes;
    chi2 += (count - expected) * (count - expected) / expected;
  }
  return chi2;
}

// 15 degrees of freedom: 99.99 % are below 44.3.
constexpr double most_chi2 = 44.3;

// The size s of two independent normal slopes is below s with 1 − exp(−s²/2σ²), that of slopes even
// over a disc of radius σ with s²/σ².
TEST(SlopeErrorShapes, FollowTheirDistributions) {
  const double sigma = 0.004;
  const auto gaussian = [=](double s) { return -std::expm1(-s * s / (2 * sigma * sigma)); };
  const auto pillbox = [=](double s) { return s * s / (sigma * sigma) * (1 - 1e-9); };
  EXPECT_LT(rings_chi2(*slope_error(sigma), gaussian), most_chi2);
  EXPECT_LT(rings_chi2(*slope_error(sigma, SlopeShape::pillbox), pillbox), most_chi2);
  // Mutants: a hundredth wider, the radius for the standard deviation, radii in place of areas.
  EXPECT_GT(rings_chi2(*slope_error(1.01 * sigma), gaussian), most_chi2);
  EXPECT_GT(rings_chi2(*slope_error(sigma, SlopeShape::pillbox), gaussian), most_chi2);
  EXPECT_GT(rings_chi2(*slope_error(sigma, SlopeShape::pillbox),
                       [=](double s) { return s / sigma * (1 - 1e-9); }),
            most_chi2);
}

// Standard deviations of rays' slopes along the axis and across it, whatever the plane of
// incidence: σ for a Gaussian, half of the semi-axis for an even ellipse.
TEST(SlopeErrorShapes, HaveTheirSizesAlongTheSurfacesAxes) {
  const double first = 0.006, second = 0.002;
  for (const auto& [shape, part] :
       {std::pair(SlopeShape::gaussian, 1.0), {SlopeShape::pillbox, 0.5}}) {
    const OpticalSurface surface = fixtures::uneven_slopes(1.0, first, second, shape);
    const Vec2 axis(0.6, 0.8), across(-0.8, 0.6);
    for (const double azimuth_deg : {0.0, 53.13, 100.0, 250.0}) {
      const double azimuth = azimuth_deg * degree_rad, tilt = 0.3;
      const Vec3 in(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                    std::cos(tilt));
      const Incidence incidence(-in, Vec3::UnitZ());
      double along2 = 0, across2 = 0, mixed = 0;
      for (uint64_t i = 0; i < rays; ++i) {
        const Vec3 out =
            scattered_direction(surface, Component::specular, incidence, random_draw(i));
        const Vec3 normal = (in + out).normalized();
        const Vec2 slope = Vec2(normal.x(), normal.y()) / normal.z();
        along2 += std::pow(slope.dot(axis), 2) / rays;
        across2 += std::pow(slope.dot(across), 2) / rays;
        mixed += slope.dot(axis) * slope.dot(across) / rays;
      }
      // A standard deviation from n draws is known to 1/√(2n): 0.14 %.
      EXPECT_NEAR(std::sqrt(along2), part * first, 0.006 * part * first) << azimuth_deg;
      EXPECT_NEAR(std::sqrt(across2), part * second, 0.006 * part * second) << azimuth_deg;
      EXPECT_LT(std::abs(mixed), 5 * part * part * first * second / std::sqrt(rays)) << azimuth_deg;
    }
  }
}

// f(i, o) = f(o, i), the axis standing still while the planes of incidence differ.
TEST(SlopeErrorShapes, ScatterReciprocallyAboutTheirAxis) {
  const auto lobe = slope_error(0.08, 0.02, SlopeShape::gaussian);
  const auto f = [&](const Vec3& in, const Vec3& out) {
    const double sine = std::hypot(in.x(), in.y());
    const Vec2 x = Vec2(in.x(), in.y()) / sine;
    // Both in the frame whose x points towards the light; the axis is the lab's x.
    const Vec3 there(out.x() * x.x() + out.y() * x.y(), out.y() * x.x() - out.x() * x.y(), out.z());
    return lobe->density({in.z(), x.x(), -x.y()}, there) / there.z();
  };
  int compared = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    const Draw draw = random_draw(i);
    const Vec3 in = lambertian_direction(0.7 * draw.u, draw.v);
    const Vec3 normal =
        Vec3(0.1 * (draw.extra(1) - 0.5), 0.04 * (draw.extra(2) - 0.5), 1).normalized();
    const Vec3 out = 2 * in.dot(normal) * normal - in;
    if (out.z() < 0.4) continue;
    EXPECT_NEAR(f(in, out) / f(out, in), 1.0, 2e-4);
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

// Light that comes evenly from everywhere leaves evenly: o_z² is even.
TEST(SlopeErrorShapes, AreInvisibleInAWhiteFurnaceAboutTheirAxis) {
  const auto lobe = slope_error(0.05, 0.02, SlopeShape::gaussian);
  std::array<double, classes> counted{};
  for (uint64_t i = 0; i < rays; ++i) {
    const Draw draw = random_draw(i);
    const double cosine = std::sqrt(draw.extra(11)), turn = 2 * pi * draw.extra(12);
    const Vec3 out = lobe->direction({cosine, std::cos(turn), std::sin(turn)}, draw);
    counted[std::min<size_t>(static_cast<size_t>(classes * out.z() * out.z()), classes - 1)] += 1.0;
  }
  double chi2 = 0.0;
  for (const double count : counted) {
    const double expected = static_cast<double>(rays) / classes;
    chi2 += (count - expected) * (count - expected) / expected;
  }
  EXPECT_LT(chi2, most_chi2);
}

// The table of mean directions against the mean of rays, for planes of incidence between its nodes.
TEST(SlopeErrorShapes, MeanDirectionIsThatOfRays) {
  const auto lobe = slope_error(0.15, 0.03, SlopeShape::gaussian);
  for (const double turn : {0.2, 0.9, 1.3, 2.0}) {
    const Arrival light(0.8, std::cos(turn), std::sin(turn));
    Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
    for (uint64_t i = 0; i < rays; ++i) {
      const Vec3 out = lobe->direction(light, random_draw(i));
      sum += out / rays;
      squares += out.cwiseProduct(out) / rays;
    }
    const Vec3 error = ((squares - sum.cwiseProduct(sum)) / rays).cwiseSqrt();
    const Vec3 mean = lobe->mean_direction(light);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(mean[k], sum[k], 4.5 * error[k]) << turn << " axis " << k;
    }
    EXPECT_GT(std::abs(mean.y()), 10 * error.y()) << turn;  // an even surface has none
  }
}

}  // namespace
}  // namespace photorque
