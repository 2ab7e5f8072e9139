// Estimates, transforms, spectra and files against hand-computed and published numbers.
#include <gtest/gtest.h>
#include <filesystem>
#include <span>
#include <vector>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/product.h"
#include "core/spectrum.h"
#include "core/transform.h"

namespace photorque {
namespace {

TEST(Estimate, MeanAndErrorOfFourNumbers) {
  const std::array<double, 4> replicates = {1.0, 2.0, 3.0, 6.0};
  const Estimate e = estimate_from_replicates(replicates);
  EXPECT_DOUBLE_EQ(e.value, 3.0);
  EXPECT_DOUBLE_EQ(e.standard_error, std::sqrt(14.0 / 3.0 / 4.0));  // s² = 14/3
}

TEST(RigidTransform, ComposesAsTheNamesRead) {
  const RigidTransform lab_from_body{Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized())),
                                     Vec3(1, 0, 2)};
  const RigidTransform body_from_led{Quat(Eigen::AngleAxisd(-1.1, Vec3::UnitY())), Vec3(0, 5, 0)};
  const Vec3 p(0.1, 0.2, 0.3);
  EXPECT_TRUE((lab_from_body * body_from_led)
                  .point(p)
                  .isApprox(lab_from_body.point(body_from_led.point(p)), 1e-14));
  EXPECT_TRUE(lab_from_body.inverse().point(lab_from_body.point(p)).isApprox(p, 1e-14));
}

TEST(Tilt, LeansTheBodyAxisTowardsTheHeading) {
  const Vec3 z = lab_from_body_at(30 * degree_rad, 90 * degree_rad).direction(Vec3::UnitZ());
  EXPECT_TRUE(z.isApprox(Vec3(0, 0.5, std::sqrt(0.75)), 1e-14));
  // Heading 0 is a turn about +y.
  const Vec3 x = lab_from_body_at(30 * degree_rad, 0).direction(Vec3::UnitX());
  EXPECT_TRUE(x.isApprox(Vec3(std::sqrt(0.75), 0, -0.5), 1e-14));
}

TEST(Frame, LooksAlongAnyDirection) {
  for (const Vec3& d : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, -2, 0.5), Vec3(1e-9, 0, -1)}) {
    EXPECT_TRUE(frame_looking_along(d, Vec3::Zero())
                    .direction(Vec3::UnitZ())
                    .isApprox(d.normalized(), 1e-8));
  }
}

// Fractions of blackbody emission below λT: F. P. Incropera and D. P. DeWitt, Fundamentals of Heat
// and Mass Transfer, table 12.1.
TEST(Blackbody, FractionsBelowAWavelength) {
  const Spectrum body{Spectrum::Shape::blackbody, 0, 0, 5000.0};
  const auto below = [&](double lambda_T_um_K) {
    return band_fractions(body, {{0.0, lambda_T_um_K * 1e-6 / 5000.0}})[0];
  };
  EXPECT_NEAR(below(2000), 0.066728, 5e-5);
  EXPECT_NEAR(below(3000), 0.273232, 5e-5);
  EXPECT_NEAR(below(4000), 0.480877, 5e-5);
  EXPECT_NEAR(below(6000), 0.737818, 5e-5);
  EXPECT_NEAR(below(10000), 0.914199, 5e-5);
}

TEST(GaussianLine, HalfWidthHoldsThreeQuarters) {
  // Between the half-maximum points of a Gaussian: erf(√ln 2) = 0.760968.
  const Spectrum led{Spectrum::Shape::gaussian, 730e-9, 30e-9, 0};
  EXPECT_NEAR(band_fractions(led, {{715e-9, 745e-9}})[0], 0.760968, 1e-6);
}

TEST(Files, AppearWholeOrNotAtAll) {
  const auto folder = std::filesystem::temp_directory_path() / "photorque_files_test";
  std::filesystem::remove_all(folder);
  write_file_whole(folder / "a" / "ok.txt", std::string("text"));
  EXPECT_EQ(read_file(folder / "a" / "ok.txt"), "text");
  EXPECT_THROW(write_file_whole(folder / "bad.txt",
                                [](const std::filesystem::path& path) {
                                  write_file_whole(path, std::string("half"));
                                  throw NumericalError("stop");
                                }),
               NumericalError);
  EXPECT_FALSE(std::filesystem::exists(folder / "bad.txt"));
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    EXPECT_EQ(entry.path().filename(), "a");
  EXPECT_THROW(read_file(folder / "missing"), InputError);
  EXPECT_THROW(read_file(folder / "a" / "ok.txt", 3), InputError);
  std::filesystem::remove_all(folder);
}

TEST(InputError, IsOnePrintableLine) {
  const InputError error({"lab.toml", 12}, "source[0].power_W", "-3\nand more", "a number > 0");
  EXPECT_STREQ(error.what(),
               "lab.toml:12: source[0].power_W: found -3 and more, expected a number > 0");
}

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

TEST(Table, IsFilledByColumnName) {
  Table table = Table::of("maxima", "Local maxima", {"place", "power_W", "voltage_V"});
  table.row().set("voltage_V", 31.0).set("place", "left").set("power_W", 94.0);
  table.row().set("place", "right").set("power_W", 95.0).set("voltage_V", 17.0);
  ASSERT_EQ(table.columns.size(), 3u);
  EXPECT_EQ(table.columns[0].texts, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(table.columns[1].values, (std::vector<double>{94.0, 95.0}));
  EXPECT_EQ(table.column("voltage_V").values, (std::vector<double>{31.0, 17.0}));
}

TEST(Table, GetsTheColumnsOfItsFirstRow) {
  Table table = Table::of("maxima", "Local maxima");
  table.row().set("place", "left").set("power_W", 94.0);
  EXPECT_THROW(table.row().set("voltage_V", 31.0), NumericalError);
  table.row().set("power_W", 95.0).set("place", "right");
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(table.column("place").texts, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(table.column("power_W").values, (std::vector<double>{94.0, 95.0}));
}

TEST(Table, RejectsTextThatWouldShiftRows) {
  Table table = Table::of("t", "", {"a", "b"});
  EXPECT_THROW(table.row().set("c", 1.0), NumericalError);
  EXPECT_THROW(table.row().set("a", 1.0).set("a", 2.0), NumericalError);
  Table mixed = Table::of("t", "", {"a"});
  mixed.row().set("a", 1.0);
  EXPECT_THROW(mixed.row().set("a", "one"), NumericalError);
  Table left_out = Table::of("t", "", {"a", "b"});
  left_out.row().set("a", 1.0);
  EXPECT_THROW(left_out.row().set("b", 2.0), NumericalError);
}

TEST(Table, RefusesColumnsOfAnotherLengthAndNamesThatAreTaken) {
  Table table = Table::of("t", "");
  table.add("a", std::vector<double>{1.0, 2.0});
  EXPECT_THROW(table.add("b", std::vector<double>{1.0}), NumericalError);
  EXPECT_THROW(table.add("a", std::vector<double>{1.0, 2.0}), NumericalError);
  EXPECT_THROW(static_cast<void>(table.column("b")), NumericalError);
}

}  // namespace photorque
