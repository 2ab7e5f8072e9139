// Photocurrent from light in bands.
#include "photovoltaics/cell/response.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "photovoltaics/cell/model.h"

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

// 0 W without a word is no answer: light outside of the table is reported; sunlight beyond both
// ends of a table that falls to zero there is not.
TEST(LightOutside, OfTheTableIsReported) {
  const QuantumEfficiency silicon = quantum_efficiency_of("silicon_interdigitated");
  const auto reported = [](const QuantumEfficiency& efficiency, const Spectrum& spectrum) {
    const WeighedSpectrum two[] = {{spectrum, 1.0}, {spectrum, 2.0}};
    return light_outside(efficiency, two);
  };
  const auto line_at = [](double nm) {
    return Spectrum{.shape = Spectrum::Shape::gaussian, .centre_m = 1e-9 * nm, .fwhm_m = 20e-9};
  };
  EXPECT_THAT(reported(silicon, line_at(730)), testing::IsEmpty());
  EXPECT_THAT(reported(silicon, Spectrum{.shape = Spectrum::Shape::am0}), testing::IsEmpty());
  EXPECT_THAT(reported(silicon, line_at(1500)),
              testing::ElementsAre(testing::HasSubstr("100 % of the light at 1500 nm")));
  // Half of a line is beyond a table that ends at its middle.
  const QuantumEfficiency cut{{600e-9, 730e-9}, {0.9, 0.9}};
  EXPECT_THAT(reported(cut, line_at(730)),
              testing::ElementsAre(testing::HasSubstr("50.0 % of the light at 730.0 nm")));
  EXPECT_THAT(reported(cut, line_at(660)), testing::IsEmpty());
}

// Efficiency of a named cell of 1 cm² in light of one spectrum.
double efficiency(const char* name, const Spectrum& spectrum, double irradiance_W_m2) {
  for (const NamedCell& known : known_cells()) {
    if (known.name != name) continue;
    const WeighedSpectrum light[] = {{spectrum, 1.0}};
    const double amperes_W = band_responsivity_A_W(quantum_efficiency_of(name), Bands{}, light)[0];
    const CellCurve cell(parameters_at(known.model, 1e-4, 298.15));
    return cell.maximum_power(1e-4 * irradiance_W_m2 * amperes_W).power_W() /
           (1e-4 * irradiance_W_m2);
  }
  return 0.0;
}

Spectrum light_at(double nm, double fwhm_nm) {
  return {.shape = Spectrum::Shape::gaussian, .centre_m = 1e-9 * nm, .fwhm_m = 1e-9 * fwhm_nm};
}

// Published: the records of gallium arsenide and cadmium telluride in AM1.5G sunlight, 29.1 and
// 21.0 % (Solar cell efficiency tables, version 54, 2019).
TEST(NamedCells, HaveThePublishedEfficiencies) {
  const Spectrum sunlight{.shape = Spectrum::Shape::am15g};
  EXPECT_NEAR(efficiency("gallium_arsenide", sunlight, 1000.0), 0.291, 0.01);
  EXPECT_NEAR(efficiency("cadmium_telluride", sunlight, 1000.0), 0.210, 0.01);
  for (const char* name : {"silicon_heterojunction", "gallium_arsenide", "cadmium_telluride"}) {
    for (const double nm : {730.0, 850.0, 940.0}) {
      const double got = efficiency(name, light_at(nm, 30), 1000.0);
      // Neither beyond the photon energy times the largest voltage, nor beyond the edge.
      const double gap_nm = std::string(name) == "silicon_heterojunction" ? 1190.0 : 900.0;
      if (nm > gap_nm) {
        EXPECT_LT(got, 0.01) << name << nm;
      } else {
        EXPECT_GT(got, 0.25) << name << nm;
        EXPECT_LT(got, 0.75) << name << nm;
      }
    }
  }
}

TEST(NamedCells, APeakThatIsStatedHolds) {
  for (const char* name : {"silicon_heterojunction", "gallium_arsenide", "cadmium_telluride"}) {
    EXPECT_NEAR(std::ranges::max(quantum_efficiency_of(name, 0.8).efficiency), 0.8, 1e-12) << name;
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
