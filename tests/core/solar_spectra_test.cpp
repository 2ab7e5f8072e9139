#include "core/spectrum.h"

#include <gtest/gtest.h>

#include <span>
#include <vector>

namespace photorque {
namespace {

struct PublishedBand {
  double begin_nm, end_nm, percent;
};

double fraction(SolarStandard standard, double begin_nm, double end_nm) {
  return solar_fraction_below(standard, end_nm * 1e-9) -
         solar_fraction_below(standard, begin_nm * 1e-9);
}

void expect_bands(SolarStandard standard, std::span<const PublishedBand> bands, double tolerance) {
  const double all = fraction(standard, bands.front().begin_nm, bands.back().end_nm);
  for (const PublishedBand& band : bands) {
    EXPECT_NEAR(100.0 * fraction(standard, band.begin_nm, band.end_nm) / all, band.percent,
                tolerance)
        << band.begin_nm << " nm";
  }
}

// IEC 60904-9, table 1: percent of the irradiance from 400 to 1100 nm.
TEST(SolarSpectra, GroundMatchesTheBandsOfSimulatorClasses) {
  const std::vector<PublishedBand> bands = {{400, 500, 18.4}, {500, 600, 19.9}, {600, 700, 18.4},
                                            {700, 800, 14.9}, {800, 900, 12.5}, {900, 1100, 15.9}};
  expect_bands(SolarStandard::am15g, bands, 0.06);
}

// ASTM E927: percent of the irradiance from 300 to 1400 nm. Its extraterrestrial spectrum is that
// of E490, which differs from that of G173 by some percent in the ultraviolet.
TEST(SolarSpectra, SpaceMatchesTheBandsOfSimulatorClasses) {
  const std::vector<PublishedBand> bands = {{300, 400, 8.0},   {400, 500, 16.4},  {500, 600, 16.3},
                                            {600, 700, 13.9},  {700, 800, 11.2},  {800, 900, 9.0},
                                            {900, 1100, 13.1}, {1100, 1400, 12.2}};
  expect_bands(SolarStandard::am0, bands, 0.35);
}

// In the standard's own units the ground gets no more than space, but for the scattered light of
// clear sky near 1.23 µm: + 0.2 %.
TEST(SolarSpectra, AirTakesLightInEveryBand) {
  for (double nm = 280; nm < 1300; nm += 20) {
    EXPECT_LE(1000.37 * fraction(SolarStandard::am15g, nm, nm + 20),
              1.005 * 1347.9 * fraction(SolarStandard::am0, nm, nm + 20))
        << nm;
  }
}

TEST(SolarSpectra, BandsOfASourceAreSharesOfTheWhole) {
  const Bands bands{{0.0, 300e-9, 1100e-9, 1.0}};
  for (const auto shape : {Spectrum::Shape::am0, Spectrum::Shape::am15g}) {
    Spectrum spectrum;
    spectrum.shape = shape;
    const BandValues fractions = band_fractions(spectrum, bands);
    EXPECT_NEAR(fractions[0] + fractions[1] + fractions[2], 1.0, 1e-14);
    EXPECT_GT(fractions[2], 0.1);
  }
}

}  // namespace
}  // namespace photorque
