// Photocurrent from light in bands.
#include "photovoltaics/cell/response.h"

#include <gtest/gtest.h>

namespace photorque {
namespace {

// q λ / (h c) at 730 nm: 730 / 1239.841984 A/W (CODATA 2018; h c / q in eV nm).
constexpr double at_730_nm_A_W = 0.5887847;

// A narrow line whose middle is the edge between two bands: half of its light is in each, and every
// half gives its current.
TEST(BandResponsivity, LineOnAnEdgeGivesItsCurrentInBothBands) {
  const QuantumEfficiency all{{1e-8, 1e-4}, {1.0, 1.0}};
  for (const double fwhm_m : {0.5e-9, 5e-9}) {
    Spectrum line;
    line.centre_m = 730e-9;
    line.fwhm_m = fwhm_m;
    const Bands bands{{600e-9, 730e-9, 860e-9}};
    const WeighedSpectrum spectra[] = {{line, 3.0}};
    const BandValues responsivity = band_responsivity_A_W(all, bands, spectra);
    const BandValues fraction = band_fractions(line, bands);
    EXPECT_NEAR(fraction[0], 0.5, 1e-9);
    EXPECT_NEAR(fraction[0] * responsivity[0] + fraction[1] * responsivity[1], at_730_nm_A_W, 1e-6);
    EXPECT_NEAR(responsivity[0], at_730_nm_A_W, 2e-3);
    EXPECT_NEAR(responsivity[1], at_730_nm_A_W, 2e-3);
  }
}

TEST(BandResponsivity, LineInsideABandGivesNothingElsewhere) {
  const QuantumEfficiency half{{1e-8, 1e-4}, {0.5, 0.5}};
  Spectrum line;
  line.centre_m = 730e-9;
  line.fwhm_m = 0.0;
  const WeighedSpectrum spectra[] = {{line, 1.0}};
  const BandValues responsivity =
      band_responsivity_A_W(half, Bands{{600e-9, 700e-9, 860e-9}}, spectra);
  EXPECT_EQ(responsivity[0], 0.0);
  EXPECT_NEAR(responsivity[1], 0.5 * at_730_nm_A_W, 1e-6);
}

}  // namespace
}  // namespace photorque
