// Measured scattering: light follows the table.
#include "raytrace/surfaces/measured_brdf.h"

#include <gtest/gtest.h>

#include "tests/raytrace/bsdf_kinds.h"

namespace photorque {
namespace {

using fixtures::first_moment;
using fixtures::forward_scatter;
using fixtures::measured;
using fixtures::scattering_1_sr;
using fixtures::tabulated;

const double cosines_of_incidence[] = {0.1, 0.5, 0.866, 1.0};

TEST(MeasuredBrdf, AConstantIsLambertsLaw) {
  const OpticalSurface surface =
      measured(tabulated(30.0, [](double, double, double) { return 0.7 / pi; }));
  for (const double cosine : cosines_of_incidence) {
    EXPECT_NEAR(fractions_of(surface, cosine, 0).diffuse, 0.7, 1e-12);
    EXPECT_NEAR(first_moment(surface, cosine, 0).z(), 0.7 * 2 / 3, 1e-12);
    EXPECT_NEAR(first_moment(surface, cosine, 0).x(), 0.0, 1e-12);
  }
}

// f = (k/π)(1 + c cos φ sin θ_i sin θ_o) sends k forward with the momentum −k c sin θ_i/4 along x:
// ∫ cos² φ dφ ∫ sin³ θ cos θ dθ = π/4. Nodes every 5 deg make the cosine of φ 0.1 % too low.
TEST(MeasuredBrdf, ForwardScatterCarriesItsMomentumForward) {
  const OpticalSurface surface = measured(tabulated(5.0, [](double in, double out, double azimuth) {
    return 0.9 / pi * (1.0 + 0.8 * std::cos(azimuth) * std::sin(in) * std::sin(out));
  }));
  for (const double cosine : cosines_of_incidence) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    EXPECT_NEAR(first_moment(surface, cosine, 0).x(), -0.9 * 0.8 * sine / 4, 1e-3);
    EXPECT_NEAR(first_moment(surface, cosine, 0).z(), 0.9 * 2 / 3, 1e-3);
  }
}

// Another scattering law of the program, read off every 3 deg: the table must do as the law does.
TEST(MeasuredBrdf, ATableOfARoughMirrorActsAsTheRoughMirror) {
  const OpticalSurface mirror = fixtures::with_lobe(0.95, 0.0, rough_mirror(0.5));
  const OpticalSurface table = measured(tabulated(3.0, [&](double in, double out, double azimuth) {
    // Grazing light has its limit just above the horizon.
    const double lean = std::min(out, 89.9 * degree_rad);
    const Vec3 towards(-std::sin(lean) * std::cos(azimuth), std::sin(lean) * std::sin(azimuth),
                       std::cos(lean));
    return scattering_1_sr(mirror, std::cos(std::min(in, 89.9 * degree_rad)), towards, 0);
  }));
  for (const double cosine : {0.5, 0.866, 1.0}) {
    EXPECT_NEAR(fractions_of(table, cosine, 0).diffuse, 0.95, 0.005) << cosine;
    EXPECT_LT((first_moment(table, cosine, 0) - first_moment(mirror, cosine, 0)).norm(), 0.01)
        << cosine;
  }
}

TEST(MeasuredBrdf, ReportsTheDeviationFromReciprocity) {
  BrdfTable table;
  table.incidence_rad = table.scatter_rad = {0.0, 60 * degree_rad};
  table.azimuth_rad = {0.0, pi};
  table.brdf_1_sr = {0.3, 0.3, 0.2, 0.2, 0.4, 0.4, 0.3, 0.3};
  // Pairs (0, 0), (60, 0), (60, 60): differences 0, 0.2, 0; means 0.3.
  BandValues scale{};
  scale[0] = 1.0;
  EXPECT_NEAR(measured_surface("s", table, scale).asymmetry, std::sqrt(0.04 / 0.27), 1e-12);
  EXPECT_LT(measured_surface("s", forward_scatter(0.9), scale).asymmetry, 1e-15);
}

// Light from 10 deg alone was measured: that is kept, and holds for light towards 10 deg too.
TEST(MeasuredBrdf, OneMeasuredDirectionDeterminesTheReverse) {
  BrdfTable table;
  table.incidence_rad = {10 * degree_rad};
  table.scatter_rad = {0.0, 30 * degree_rad, 60 * degree_rad};
  table.azimuth_rad = {0.0};
  table.brdf_1_sr = {0.2, 0.25, 0.1};
  const OpticalSurface surface = measured(table);
  const auto f = [&](double in_deg, double out_deg) {
    const double out = out_deg * degree_rad;
    return scattering_1_sr(surface, std::cos(in_deg * degree_rad),
                           {-std::sin(out), 0.0, std::cos(out)}, 0);
  };
  EXPECT_NEAR(f(10, 30), 0.25, 1e-12);
  EXPECT_NEAR(f(30, 10), 0.25, 1e-12);
  EXPECT_NEAR(f(10, 60), 0.1, 1e-12);
  EXPECT_NEAR(f(10, 85), 0.1, 1e-12);  // beyond the last node
}

TEST(MeasuredBrdf, ScalesPerBandAndNamesWhereItIsBrightest) {
  BandValues scale{};
  scale[0] = 1.0;
  scale[1] = 1.2;
  BrdfTable table = tabulated(30.0, [](double in, double out, double) {
    return (0.5 + 0.3 * std::sin(in) * std::sin(out)) / pi;
  });
  const MeasuredSurface bright = measured_surface("s", table, scale);
  EXPECT_NEAR(bright.at_incidence_rad, 0.5 * pi, 1e-12);
  EXPECT_NEAR(bright.surface.diffuse[1], 1.2 * bright.surface.diffuse[0], 1e-12);
  EXPECT_NEAR(fractions_of(bright.surface, 1e-9, 1).diffuse, bright.largest_reflectance, 1e-6);
}

}  // namespace
}  // namespace photorque
