// IES LM-63 and EULUMDAT files: those that makers and other programs wrote, and every way to damage
// one.
#include "sources/photometry/file.h"

#include <filesystem>

#include "core/constants.h"
#include "core/files.h"
#include "sampling.h"
#include "sources/lamps/ies.h"
#include "sources/profiles/beam_shape.h"
#include "tests/refusal.h"
#include "tests/sources/ies_writer.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

using test::samples;
using test::table_direction;

PhotometricFile read_sample_table(const fs::path& path) {
  return read_photometric(read_file(path), path.filename().string());
}

PhotometricLamp lamp_of(const PhotometricFile& file) {
  return PhotometricLamp(1.0, file.opening, TabulatedIntensity(file.table));
}

const std::string small_ies =
    "IESNA:LM-63-2002\n[TEST] by hand\n[MANUFAC] maker\nTILT=NONE\n"
    "1 1000 2 3 1 1 2 -0.1 -0.1 0\n1 1 10\n0 45 90\n0\n100 50 0\n";

// The text with one of its pieces replaced.
std::string with(std::string text, const std::string& piece, const std::string& other) {
  const size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return text.replace(at, piece.size(), other);
}

void expect_refused(const std::string& text, const std::string& words) {
  const std::string message = refusal_of([&] { read_photometric(text, "lamp.ies"); });
  EXPECT_THAT(message, testing::HasSubstr(words));
  EXPECT_THAT(message, testing::HasSubstr("lamp.ies:"));
}

// Each of these once ended the program, or gave numbers that were none.
TEST(IesFile, OpeningsFartherThanAnythingBuiltAreRefused) {
  expect_refused(with(small_ies, "-0.1 -0.1 0", "1e20 1e20 0"), "found 1e+20 m, expected at most");
  expect_refused(with(small_ies, "-0.1 -0.1 0", "-1e300 0 0"), "luminous opening");
  EXPECT_NO_THROW(read_ies(with(small_ies, "-0.1 -0.1 0", "1e9 1 0"), "lamp.ies"));
}

TEST(IesFile, CandelaThatOverflowAreRefused) {
  expect_refused(with(small_ies, "100 50 0", "1e300 50 0"), "expected 1e-60 to 1e60");
  expect_refused(with(small_ies, "100 50 0", "1e-300 0 0"), "expected 1e-60 to 1e60");
}

// Found by fuzzing: turned back, 5e18 degrees were an azimuth below zero.
TEST(IesFile, HorizontalAnglesOfManyTurnsAreRefused) {
  const std::string planes =
      with(with(small_ies, "2 3 1 1 2", "2 3 4 1 2"), "0 45 90\n0\n100 50 0\n",
           "0 45 90\n0 90 180 270\n9 9 0 9 9 0 9 9 0 9 9 0\n");
  EXPECT_EQ(read_ies(planes, "lamp.ies").table.planes(), 4u);
  expect_refused(with(planes, "0 90 180 270", "0 90 180 5410163354058614529"),
                 "horizontal angles: found 5.41016e+18");
  expect_refused(with(planes, "0 90 180 270", "-1e300 90 180 270"), "horizontal angles");
}

// A count that is one too low takes the last angle for an azimuth and shifts the whole table.
TEST(IesFile, WrongVerticalCountsAreRefused) {
  const std::string many = "0 30 60 90\n0\n100 90 50 0\n";
  const std::string good = with(with(small_ies, "0 45 90\n0\n100 50 0\n", many), "2 3 1", "2 4 1");
  EXPECT_EQ(read_ies(good, "lamp.ies").table.polar_rad.size(), 4u);
  expect_refused(with(good, "2 4 1", "2 3 1"), "numbers after the last candela value");
  expect_refused(with(good, "2 4 1", "2 5 1"), "vertical angles");
}

TEST(IesFile, ListsItsContent) {
  const PhotometricFile file = read_ies(small_ies, "lamp.ies");
  EXPECT_EQ(file.format, "IESNA:LM-63-2002");
  EXPECT_EQ(file.labels.at(1), (std::pair<std::string, std::string>("MANUFAC", "maker")));
  EXPECT_EQ(file.table.intensity, (std::vector<double>{200, 100, 0}));
  EXPECT_EQ(file.stated_flux_lm, 1000.0);
  EXPECT_EQ(file.opening.shape, Opening::Shape::ellipse);
  EXPECT_DOUBLE_EQ(file.opening.x_m, 0.1);
  EXPECT_TRUE(file.notices.empty());
  const auto feet = read_ies(with(small_ies, "1 1 2 -0.1", "1 1 1 -0.1"), "lamp.ies");
  EXPECT_DOUBLE_EQ(feet.opening.y_m, 0.03048);
}

TEST(IesFile, TakesNumbersInAnyLayoutAndOlderHeaders) {
  const std::string old =
      "a lamp\nof 1986\nTILT = NONE\n1,1000,2,3 1 1 2 -0.1 -0.1 0 1 1\n\n10 "
      "+0.0,45\t9.0e1 0 100 50 0\r\n";
  const PhotometricFile file = read_ies(old, "lamp.ies");
  EXPECT_EQ(file.format, "LM-63-1986");
  EXPECT_EQ(file.table.polar_rad, read_ies(small_ies, "").table.polar_rad);
  EXPECT_EQ(file.table.intensity, (std::vector<double>{200, 100, 0}));
  const auto cr =
      read_ies(with(with(small_ies, "\n1 1 10\n", "\r1 1 10\r"), "TILT=NONE", "TILT=none"), "");
  EXPECT_EQ(cr.table.intensity, file.table.intensity);
}

// Planes to 190 degrees and none beyond: nothing in the file says what the other half does.
TEST(IesFile, MissingPlanesAreReported) {
  const auto make = [](int last_deg, int skip_deg) {
    std::string horizontal, rows;
    int count = 0;
    for (int c = 0; c <= last_deg; c += 10) {
      if (c == skip_deg) continue;
      horizontal += std::to_string(c) + " ";
      rows += "100 50 0\n";
      ++count;
    }
    return read_ies(with(with(small_ies, "2 3 1 1 2", "2 3 " + std::to_string(count) + " 1 2"),
                         "0 45 90\n0\n100 50 0\n", "0 45 90\n" + horizontal + "\n" + rows),
                    "lamp.ies");
  };
  EXPECT_TRUE(make(350, -1).notices.empty());
  EXPECT_TRUE(make(350, 120).notices.empty());  // one of 36
  EXPECT_TRUE(make(180, -1).notices.empty());   // two halves alike
  const PhotometricFile half = make(190, -1);
  ASSERT_EQ(half.notices.size(), 1u);
  EXPECT_NE(half.notices[0].find("no plane between 190 and 360 degrees"), std::string::npos)
      << half.notices[0];
}

// A factor that the edition of 2019 replaced by a kind of test.
TEST(IesFile, SecondFactorCountsBefore2019Only) {
  const std::string half = with(small_ies, "\n1 1 10", "\n0.5 0.5 10");
  EXPECT_DOUBLE_EQ(read_ies(half, "").table.intensity[0], 50.0);
  EXPECT_DOUBLE_EQ(
      read_ies(with(half, "IESNA:LM-63-2002", "IES:LM-63-2019"), "").table.intensity[0], 100.0);
}

TEST(IesFile, UnfoldsEverySymmetry) {
  const auto make = [](const std::string& horizontal, int count, const std::string& rows) {
    return read_ies("TILT=NONE\n1 -1 1 2 " + std::to_string(count) + " 1 2 0 0 0 1 1 1\n0 90\n" +
                        horizontal + "\n" + rows,
                    "");
  };
  const auto value_at = [](const PhotometricFile& file, double azimuth_deg) {
    return TabulatedIntensity(file.table).at(0.0, azimuth_deg * deg);
  };
  const auto quadrant = make("0 45 90", 3, "1 0 2 0 3 0");
  for (const double c : {45.0, 135.0, 225.0, 315.0}) EXPECT_NEAR(value_at(quadrant, c), 2, 1e-12);
  EXPECT_NEAR(value_at(quadrant, 180), 1, 1e-12);
  EXPECT_NEAR(value_at(quadrant, 270), 3, 1e-12);
  const auto bilateral = make("0 90 180", 3, "1 0 2 0 3 0");
  EXPECT_NEAR(value_at(bilateral, 270), 2, 1e-12);
  EXPECT_NEAR(value_at(bilateral, 180), 3, 1e-12);
  const auto fore_aft = make("90 180 270", 3, "1 0 2 0 3 0");
  EXPECT_NEAR(value_at(fore_aft, 0), 2, 1e-12);
  EXPECT_NEAR(value_at(fore_aft, 90), 1, 1e-12);
  EXPECT_NEAR(value_at(fore_aft, 270), 3, 1e-12);
  const auto full = make("0 90 180 270 360", 5, "1 0 2 0 3 0 4 0 1 0");
  EXPECT_EQ(full.table.planes(), 4u);
  EXPECT_NEAR(value_at(full, 315), 2.5, 1e-12);
}

TEST(IesFile, NamesTheLineOfTheMistake) {
  expect_refused(with(small_ies, "TILT=NONE\n", ""), "TILT");
  expect_refused(with(small_ies, "100 50 0", "100 fifty 0"),
                 "lamp.ies:9: candela value: found \"fifty\"");
  expect_refused(with(small_ies, "100 50 0\n", "100 50\n"), "the end of the file");
  expect_refused(with(small_ies, "0 45 90", "0 95 90"), "found 90 after 95");
  expect_refused(with(small_ies, "0 45 90", "0 45 190"), "0 to 180");
  expect_refused(with(small_ies, "2 3 1 1 2", "2 3 1 4 2"), "photometric type");
  expect_refused(with(small_ies, "2 3 1 1 2", "2 1e9 1 1 2"), "number of vertical angles");
  expect_refused(with(small_ies, "2 3 1 1 2", "2 99999 99999 1 2"), "lamp.ies");
  expect_refused(with(small_ies, "1 1000 2", "1 1000 -2"), "candela multiplier");
  expect_refused(with(small_ies, "100 50 0", "0 0 0"), "none above zero");
  expect_refused(with(small_ies, "100 50 0", "1e308 1e308 1e309"), "candela value");
  expect_refused("", "lamp.ies");
  for (size_t length = 0; length < small_ies.size() - 3; ++length) {
    EXPECT_THROW(read_photometric(small_ies.substr(0, length), "cut"), InputError) << length;
  }
}

TEST(IesFile, NegativeCandelaCountAsZeroWithANotice) {
  const auto file = read_ies(with(small_ies, "100 50 0", "100 50 -1"), "");
  EXPECT_EQ(file.table.intensity.back(), 0.0);
  ASSERT_EQ(file.notices.size(), 1u);
  EXPECT_THAT(file.notices[0], testing::HasSubstr("1 negative"));
}

void expect_equal(const PhotometricFile& a, const PhotometricFile& b) {
  EXPECT_EQ(a.table.pole, b.table.pole);
  EXPECT_EQ(a.table.closed, b.table.closed);
  ASSERT_EQ(a.table.polar_rad.size(), b.table.polar_rad.size());
  ASSERT_EQ(a.table.planes(), b.table.planes());
  // Radian, degree and radian again: two units in the last place of π and of 2π.
  for (size_t i = 0; i < a.table.polar_rad.size(); ++i) {
    EXPECT_NEAR(a.table.polar_rad[i], b.table.polar_rad[i], 1e-15);
  }
  for (size_t i = 0; i < a.table.planes(); ++i) {
    EXPECT_NEAR(a.table.azimuth_rad[i], b.table.azimuth_rad[i], 2e-15);
  }
  EXPECT_EQ(a.table.intensity, b.table.intensity);
  EXPECT_EQ(a.stated_flux_lm, b.stated_flux_lm);
  EXPECT_EQ(a.input_power_W, b.input_power_W);
  EXPECT_EQ(a.opening.shape, b.opening.shape);
  EXPECT_DOUBLE_EQ(a.opening.x_m, b.opening.x_m);
  EXPECT_DOUBLE_EQ(a.opening.y_m, b.opening.y_m);
}

TEST(IesFile, OfTypesAAndBComesBackAsWritten) {
  for (const char* type : {"2", "3"}) {
    const std::string text = std::string("IESNA91\nTILT=NONE\n1 -1 1 3 5 ") + type +
                             " 2 0.1 0.2 0 1 1 5\n0 10 20\n-20 -10 0 10 20\n" +
                             "1 2 3\n4 5 6\n7 8 9\n10 11 12\n13 14 15\n";
    const PhotometricFile file = read_ies(text, "");
    EXPECT_EQ(file.table.intensity.size(), 25u);  // V from −20 to 20
    expect_equal(file, read_ies(write_ies(file), ""));
    // V = 10, H = −10 is 5, on either side of the horizon.
    const Vec3 d = file.table.pole == Pole::vertical
                       ? table_direction(Pole::vertical, 80 * deg, -10 * deg)
                       : table_direction(Pole::horizontal, 100 * deg, 10 * deg);
    const GoniometerAngles at = table_angles(file.table.pole, d);
    EXPECT_NEAR(TabulatedIntensity(file.table).at(at.polar_rad, at.azimuth_rad), 5.0, 1e-9);
    EXPECT_GT(d.x(), 0.0);
    EXPECT_LT(d.y(), 0.0);
  }
}

// LM-63-2002, definitions: horizontal angles count clockwise seen from above, so that the
// directions of H = 30, of V = 30 and of the beam are left-handed.
TEST(IesFile, OfTypesAAndBCountHorizontalAnglesClockwise) {
  constexpr double sine = 0.5, cosine = 0.86602540378443865;
  for (const char* type : {"2", "3"}) {
    for (const bool along_v : {false, true}) {
      const std::string angles = "-60 -30 0 30 60\n", dark = "0 0 0 0 0\n";
      const std::string planes = along_v ? dark + dark + "0 0 0 1000 0\n" + dark + dark
                                         : dark + dark + dark + "0 0 1000 0 0\n" + dark;
      const PhotometricFile file =
          read_ies(std::string("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 5 5 ") + type +
                       " 2 0 0 0\n1 1 10\n" + angles + angles + planes,
                   "");
      // In the emitter's frame, which looks along z with C0 along x and C90 along −y.
      const Vec3 expected = along_v ? Vec3(sine, 0.0, cosine) : Vec3(0.0, sine, cosine);
      const TabulatedIntensity intensity(file.table);
      const auto at = [&](const Vec3& direction) {
        const GoniometerAngles angle = table_angles(file.table.pole, direction);
        return intensity.at(angle.polar_rad, angle.azimuth_rad);
      };
      EXPECT_NEAR(at(expected), 1000.0, 1e-6) << type;
      EXPECT_NEAR(at({-expected.x(), -expected.y(), cosine}), 0.0, 1e-6) << type;
    }
  }
}

TEST(IesFile, NamesTheMissingBallastLine) {
  const std::string head = "IESNA:LM-63-2002\nTILT=NONE\n1 900 1 3 1 1 2 0 0 0\n";
  for (const char* angles : {"0 45 90\n", "90 120 180\n", "0\n45\n90\n"}) {
    const std::string message =
        refusal_of([&] { read_ies(head + angles + "0\n120 90 30\n", "lamp.ies"); });
    EXPECT_THAT(message, testing::HasSubstr("lamp.ies:4: ballast factor"));
    EXPECT_THAT(message, testing::HasSubstr("no such line"));
  }
  EXPECT_THAT(refusal_of([&] { read_ies(head + "0 1 10\n0 45 90\n0\n120 90 30\n", "lamp.ies"); }),
              testing::HasSubstr("lamp.ies:4: ballast factor: found 0"));
}

TEST(PhotometricSamples, AreAllReadAndComeBackAsWritten) {
  PHOTORQUE_NEEDS_THIRD_PARTY("photometry");
  int files = 0;
  for (const char* folder : {"ies", "ldt", "synthetic"}) {
    for (const auto& entry : fs::directory_iterator(samples() / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".ies" && extension != ".ldt") continue;
      ++files;
      SCOPED_TRACE(entry.path().filename().string());
      const PhotometricFile file = read_sample_table(entry.path());
      expect_equal(file, read_ies(write_ies(file), "written"));
      const TabulatedIntensity intensity(file.table);
      EXPECT_GT(intensity.flux(), 0.0);
      EXPECT_TRUE(std::isfinite(intensity.flux()));
    }
  }
  EXPECT_EQ(files, 29);
}

// 2π Σ of the mean of neighbouring values times the difference of their cosines.
double flux_by_means(const PhotometricLamp& lamp) {
  const TabulatedIntensity& intensity = lamp.intensity();
  const std::vector<double>& polar = intensity.table().polar_rad;
  double sum = 0.0;
  for (size_t i = 0; i + 1 < polar.size(); ++i) {
    sum += pi * (intensity.mean(polar[i]) + intensity.mean(polar[i + 1])) *
           (std::cos(polar[i]) - std::cos(polar[i + 1]));
  }
  return sum;
}

// Widths and flux by another program (index.txt), which draws straight lines between the angles and
// takes the flux by means. These tables are coarse, and a smooth curve is up to 2 % wider.
TEST(PhotometricSamples, AgreeWithAnotherProgram) {
  PHOTORQUE_NEEDS_THIRD_PARTY("photometry");
  struct Known {
    const char* file;
    double fwhm_deg, tenth_deg, flux;
  };
  for (const Known& known :
       {Known{"ies/007cfb11e343e2f42e3b476be4ab684e.ies", 54.44, 88.43, 321.53},
        Known{"ies/imperial_units.ies", 25.35, 78.70, 906.57},
        Known{"ies/absolute_photometry_with_multiplier.ies", 25.35, 78.70, 1359.9},
        Known{"ies/06b4cfdc8805709e767b5e2e904be8ad.ies", 31.77, 82.82, 1232.4},
        Known{"ies/ABSOLUTE_LED.ies", 72.86, 120.0, 5184.8},
        Known{"ies/TILT_TEST_SYNTHETIC.ies", 120.0, 180.0, 3266.2}}) {
    SCOPED_TRACE(known.file);
    const PhotometricLamp lamp = lamp_of(read_sample_table(samples() / known.file));
    EXPECT_NEAR(full_width_rad(lamp, 0.5) / deg, known.fwhm_deg, 0.02 * known.fwhm_deg);
    EXPECT_NEAR(full_width_rad(lamp, 0.1) / deg, known.tenth_deg, 0.02 * known.tenth_deg);
    EXPECT_NEAR(flux_by_means(lamp) / known.flux, 1.0, 5e-5);
  }
}

struct Answer {
  const char* name;
  double fwhm_deg, half_deg, ninety_deg, ninety_nine_deg, within_1_5, within_3;
};

// Closed forms, to the digits given.
TEST(PhotometricSamples, ReproduceTheAnswersOfSyntheticBeams) {
  for (const Answer& answer :
       {Answer{"gauss3", 3.0000, 1.4999, 2.7337, 3.8660, 0.50006, 0.93753},
        Answer{"core3_halo12_20pct", 3.0310, 1.7497, 5.9926, 12.4571, 0.40855, 0.78192}}) {
    for (const char* extension : {".ies", ".ldt"}) {
      SCOPED_TRACE(std::string(answer.name) + extension);
      const fs::path path =
          outside::reference_data("beams") / (std::string(answer.name) + extension);
      const PhotometricLamp lamp = lamp_of(read_sample_table(path));
      const EncircledFlux flux(lamp);
      EXPECT_NEAR(full_width_rad(lamp, 0.5) / deg, answer.fwhm_deg, 2e-4);
      EXPECT_NEAR(flux.half_angle_rad(0.5) / deg, answer.half_deg, 2e-4);
      EXPECT_NEAR(flux.half_angle_rad(0.9) / deg, answer.ninety_deg, 1e-3);
      EXPECT_NEAR(flux.half_angle_rad(0.99) / deg, answer.ninety_nine_deg, 2e-3);
      EXPECT_NEAR(flux.within(1.5 * deg), answer.within_1_5, 2e-5);
      EXPECT_NEAR(flux.within(3.0 * deg), answer.within_3, 2e-5);
      EXPECT_NEAR(lamp.intensity().flux() / 1000.0, 1.0, 1e-6);  // of 1 W, in mW
    }
  }
}

TEST(EulumdatFile, RefusesDamage) {
  PHOTORQUE_NEEDS_THIRD_PARTY("photometry");
  const std::string good = read_file(samples() / "ldt/0-4-2.ldt");
  EXPECT_NO_THROW(read_eulumdat(good, "good"));
  for (size_t length = 0; length + 4 < good.size(); ++length) {
    EXPECT_THROW(read_eulumdat(good.substr(0, length), "cut"), InputError) << length;
  }
  expect_refused(with(good, "\n4\n24\n", "\n7\n24\n"), "lamp.ies:3: symmetry indicator: found 7");
  expect_refused(with(good, "\n24\n15\n", "\n23\n15\n"), "a multiple of 4");
}

// Decimal commas, and the planes of each symmetry where the other program has them: C270 first for
// symmetry 3.
TEST(EulumdatFile, SymmetryToC90C270StartsAtC270) {
  std::string text =
      "maker\r\n3\r\n3\r\n4\r\n90\r\n2\r\n90\r\n\r\n\r\n\r\n\r\n\r\n100\r\n0\r\n0\r\n40\r\n0\r\n"
      "0\r\n0\r\n0\r\n0\r\n100\r\n100\r\n1,0\r\n0\r\n1\r\n1\r\nLED\r\n2000\r\n\r\n\r\n5\r\n";
  for (int i = 0; i < 10; ++i) text += "0\r\n";
  text += "0\r\n90\r\n180\r\n270\r\n0\r\n90\r\n1,5\r\n0\r\n2,5\r\n0\r\n3,5\r\n0\r\n";
  const PhotometricFile file = read_eulumdat(text, "");
  EXPECT_EQ(file.stated_flux_lm, 2000.0);
  EXPECT_EQ(file.opening.shape, Opening::Shape::ellipse);
  EXPECT_DOUBLE_EQ(file.opening.x_m, 0.04);
  const TabulatedIntensity intensity(file.table);
  EXPECT_NEAR(intensity.at(0, 270 * deg), 3.0, 1e-12);  // 1.5 cd/klm · 2 klm
  EXPECT_NEAR(intensity.at(0, 0), 5.0, 1e-12);
  EXPECT_NEAR(intensity.at(0, 180 * deg), 5.0, 1e-12);
  EXPECT_NEAR(intensity.at(0, 90 * deg), 7.0, 1e-12);
}

// A symmetric half or quarter of the planes ends on a plane of the file, which for a half needs an
// even number of them alone.
TEST(EulumdatFile, SymmetryToC0C180NeedsAnEvenNumberOfPlanes) {
  const auto lamp = [](const std::string& maker, const std::string& tilt_deg) {
    std::string text =
        maker +
        "\n3\n2\n6\n60\n2\n90\n\nTILT LED\n\n\n\n100\n0\n0\n40\n0\n0\n0\n0\n0\n100\n100\n"
        "1\n" +
        tilt_deg + "\n1\n1\nLED\n1000\n\n\n5\n";
    for (int i = 0; i < 10; ++i) text += "0\n";
    return text + "0\n60\n120\n180\n240\n300\n0\n90\n1\n0\n2\n0\n3\n0\n4\n0\n";
  };
  // Neither a maker nor a lamp whose name begins so makes it a file of the IES.
  const PhotometricFile file = read_photometric(lamp("IES Leuchten", "0"), "lamp.ldt");
  EXPECT_EQ(file.format, "EULUMDAT");
  const TabulatedIntensity intensity(file.table);
  for (const double c_deg : {60.0, 300.0}) EXPECT_NEAR(intensity.at(0, c_deg * deg), 2.0, 1e-12);
  for (const double c_deg : {120.0, 240.0}) EXPECT_NEAR(intensity.at(0, c_deg * deg), 3.0, 1e-12);
  EXPECT_NEAR(intensity.at(0, 180 * deg), 4.0, 1e-12);
  const PhotometricFile tilted = read_photometric(lamp("maker", "15"), "lamp.ldt");
  EXPECT_EQ(tilted.notices.size(), file.notices.size() + 1);
  EXPECT_EQ(tilted.notices.front(),
            "measured at a tilt of 15 deg, by which the lamp is not turned");
}

TEST(IesFile, AnyWordThatBeginsWithTiltIsNotItsTiltLine) {
  const std::string text = with(small_ies, "[TEST] by hand\n", "Tilting bracket 2\n");
  EXPECT_EQ(read_photometric(text, "lamp.ies").table.intensity,
            read_photometric(small_ies, "lamp.ies").table.intensity);
  // Version of 1986, without a line that names the format.
  const std::string small =
      with(with(small_ies, "IESNA:LM-63-2002\n", ""), "TILT=NONE", "tilt = none");
  EXPECT_EQ(read_photometric(small, "lamp.ies").format, "LM-63-1986");
}

}  // namespace
}  // namespace photorque
