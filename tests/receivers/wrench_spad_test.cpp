#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "receiver_scenes.h"
#include "receivers/wrench/spad.h"
#include "tests/outside.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;
using testing::input_error_of;

// Azimuths −180, 0, 180 and elevations −90, 0, 90; rows in any order; square inches.
const std::string small_file = R"(Version            : 4.22
System             : box: small
Analysis Type      : Area
Pressure           : 1
Center of Mass     :  (0.5, -1, +2.25)
Current time       : Jun  6, 2013  10:12:52.00

Motion    : 1
  Name    : Azimuth
  Method  : Step
  Minimum : -180
  Maximum : 180
  Step    : 180
Motion    : 2
  Name    : Elevation
  Method  : Step
  Minimum : -90
  Maximum : 90
  Step    : 90
: END

Record count       : 9

 AzimuthElevatio  Force(X)  Force(Y)  Force(Z)
 degrees degrees      in^2      in^2      in^2
 ------- ------- --------- --------- ---------
 -180.00  -90.00  1 2 3
 -180.00   90.00  1 2 3
 -180.00    0.00  1 2 3
    0.00  -90.00  1 2 3
    0.00    0.00  10 20 30
    0.00   90.00  1 2 3
  180.00  -90.00  1 2 3
  180.00    0.00  1 2 3
  180.00   90.00  1 2 3
 ------- ------- --------- --------- ---------
)";

// Largest difference of force between nodes of one direction (all azimuths at a pole, the first and
// the last elsewhere) over the largest force of a table that goes all round.
double spread_of(const WrenchTable& table) {
  double spread = 0.0, largest = 0.0;
  for (size_t polar = 0; polar < table.polar_rad.size(); ++polar) {
    const bool is_pole = std::abs(std::cos(table.polar_rad[polar])) < 1e-9;
    const Vec3& first = table.force_body_N[table.node(0, polar)];
    for (size_t around = 0; around < table.around_rad.size(); ++around) {
      const Vec3& force = table.force_body_N[table.node(around, polar)];
      largest = std::max(largest, force.norm());
      if (is_pole || around + 1 == table.around_rad.size()) {
        spread = std::max(spread, (force - first).norm());
      }
    }
  }
  return spread / largest;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// Asymmetric enough that no index or sign can be mistaken for another.
WrenchTable sample_table(bool with_torque) {
  std::vector<double> elevations, azimuths;
  for (int i = 0; i <= 12; ++i) elevations.push_back((-90 + 15 * i) * degree_rad);
  for (int i = 0; i <= 36; ++i) azimuths.push_back((-180 + 10 * i) * degree_rad);
  WrenchTable table = make_wrench_table(WrenchTable::Angles::azimuth_elevation, elevations,
                                        azimuths, {0.25, -0.5, 1.0 / 3.0});
  for (size_t a = 0; a < azimuths.size(); ++a) {
    for (size_t p = 0; p < elevations.size(); ++p) {
      const Vec3 u = towards_light({elevations[p], azimuths[a]});
      table.force_body_N[table.node(a, p)] = -(2 + u.x() + 0.5 * u.y() * u.z()) * u * 1e-3;
      if (with_torque) {
        table.torque_body_N_m[table.node(a, p)] = Vec3(0.1, 0.2, 0.3).cross(u) * 1e-5;
      }
    }
  }
  return table;
}

std::filesystem::path sample(const std::string& name) {
  return outside::third_party("spad") / name;
}

TEST(Spad, ReadsRowsInAnyOrderAndInches) {
  const SpadFile file = parse_spad(small_file, "small.spo");
  EXPECT_EQ(file.system, "box: small");
  EXPECT_FALSE(file.has_torque);
  EXPECT_EQ(file.table.about_body_m, Vec3(0.5, -1, 2.25));
  const Wrench front = wrench_at(file.table, {0.0, 0.0});
  EXPECT_LT((front.force_N - Vec3(10, 20, 30) * 0.0254 * 0.0254).norm(), 1e-16);
  const Wrench behind = wrench_at(file.table, {0.0, pi});
  EXPECT_LT((behind.force_N - Vec3(1, 2, 3) * 0.0254 * 0.0254).norm(), 1e-16);
}

TEST(Spad, SaysWhatIsWrongAndWhere) {
  const auto message = [](const std::string& from, const std::string& to) {
    return input_error_of([&] { parse_spad(replaced(small_file, from, to), "small.spo"); });
  };
  EXPECT_THAT(message("Area", "Drag"), HasSubstr("small.spo:3"));
  EXPECT_THAT(message("10 20 30", "10 2O 30"), HasSubstr("small.spo:31: force: found \"2O\""));
  EXPECT_THAT(message("10 20 30", "10 nan 30"), HasSubstr("a finite number"));
  EXPECT_THAT(message("10 20 30", "10 20"), HasSubstr("small.spo:31"));
  EXPECT_THAT(message("    0.00    0.00  10", "    0.00   45.00  10"), HasSubstr("on the grid"));
  EXPECT_THAT(message("    0.00    0.00  10", "    0.00   90.00  10"), HasSubstr("once"));
  EXPECT_THAT(message("Record count       : 9", "Record count       : 8"), HasSubstr("found 9"));
  EXPECT_THAT(message(" -180.00    0.00  1 2 3\n", ""), HasSubstr("found 8"));
  EXPECT_THAT(message("Step    : 180", "Step    : 0"), HasSubstr("small.spo:13"));
  EXPECT_THAT(message("Step    : 180", "Step    : 7"), HasSubstr("small.spo:13"));
  EXPECT_THAT(message("in^2      in^2      in^2", "in^2 in^2 ft^2"), HasSubstr("units"));
  EXPECT_THAT(message("in^2      in^2      in^2", "acre acre acre"), HasSubstr("units"));
  EXPECT_THAT(message(": Elevation", ": Roll"), HasSubstr("Azimuth and Elevation"));
  EXPECT_THAT(message("(0.5, -1, +2.25)", "(0.5, -1)"), HasSubstr("small.spo:5"));
  // Ranges that would take 10^10 directions, or that change after their step: once no memory, once
  // a conversion without a meaning.
  EXPECT_THAT(message("Step    : 180", "Step    : 0.004"), HasSubstr("by the ranges"));
  EXPECT_THAT(message("Step    : 180\n", "Step    : 180\n  Minimum : -1e300\n"),
              HasSubstr("for Azimuth a positive step"));
  EXPECT_THAT(input_error_of([] { parse_spad("", "empty.spo"); }), HasSubstr("end of the file"));
  for (size_t length = 0; length <= small_file.rfind('3'); length += 13) {
    EXPECT_NE(input_error_of([&] { parse_spad(small_file.substr(0, length), "cut.spo"); }), "");
  }
}

TEST(Spad, WritingAndReadingKeepsTwelveDigits) {
  for (const bool with_torque : {false, true}) {
    const WrenchTable table = sample_table(with_torque);
    const std::string text = format_spad({"body", table, with_torque}, "photorque 1: a.toml:12ab");
    const SpadFile file = parse_spad(text, "written.spo");
    EXPECT_EQ(file.system, "body");
    EXPECT_EQ(file.has_torque, with_torque);
    EXPECT_LT((file.table.about_body_m - table.about_body_m).norm(), 1e-11);
    ASSERT_EQ(file.table.nodes(), table.nodes());
    for (size_t i = 0; i < table.nodes(); ++i) {
      EXPECT_LT((file.table.force_body_N[i] - table.force_body_N[i]).norm(), 1e-14);
      EXPECT_LT((file.table.torque_body_N_m[i] - table.torque_body_N_m[i]).norm(), 1e-16);
    }
  }
}

TEST(Spad, WrittenFilesKeepTheRulesOfTheReaderInGmat) {
  // GMAT R2026a, SPADFileReader: every header line has exactly one colon, titles begin with Azimuth
  // and units with "degrees degrees m^2 m^2 m^2", and the poles must be there.
  const std::string text =
      format_spad({"a: b", sample_table(true), true}, "photorque 1 inputs a.toml:12ab\nb");
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line) && line.find("Azimuth Elevation") == std::string::npos) {
    if (line.empty()) continue;
    EXPECT_EQ(std::count(line.begin(), line.end(), ':'), 1) << line;
  }
  EXPECT_TRUE(line.starts_with(" Azimuth"));
  std::getline(lines, line);
  EXPECT_THAT(line, HasSubstr("degrees degrees m^2 m^2 m^2"));
  EXPECT_THAT(text, HasSubstr("Record count       : 481"));
  EXPECT_THAT(text, HasSubstr("a.toml=12ab"));
}

TEST(Spad, WrittenFilesAreSingleValued) {
  WrenchTable noisy = sample_table(true);
  for (size_t i = 0; i < noisy.nodes(); ++i) {
    noisy.force_body_N[i] *= 1 + 0.01 * std::sin(12.9898 * static_cast<double>(i));
  }
  EXPECT_GT(spread_of(noisy), 1e-3);
  const SpadFile file = parse_spad(format_spad({"body", noisy, true}, "test"), "written.spo");
  EXPECT_LT(spread_of(file.table), 1e-12);
}

TEST(Spad, OnlyTheWholeSphereIsWritten) {
  WrenchTable tilts = make_wrench_table(WrenchTable::Angles::tilt_heading, {0.0, 0.1}, {0.0});
  EXPECT_THROW(format_spad({"body", tilts, true}, "test"), InputError);
  WrenchTable half =
      make_wrench_table(WrenchTable::Angles::azimuth_elevation, {0.0, pi / 2}, {-pi, 0.0, pi});
  EXPECT_THROW(format_spad({"body", half, true}, "test"), InputError);
}

TEST(Spad, ReadsATableOfJwst) {
  PHOTORQUE_NEEDS_THIRD_PARTY("spad");
  const SpadFile file = read_spad(sample("JWST-10cm1R.spo"));
  EXPECT_EQ(file.system, "JWST");
  EXPECT_TRUE(file.has_torque);
  EXPECT_EQ(file.table.nodes(), 1369u);
  EXPECT_EQ(file.table.about_body_m, Vec3(0.038, 0.0215, 3.999));
  // Two rows of the file, at azimuth −180 deg; the second at elevation −85 deg.
  EXPECT_LT((file.table.force_body_N[0] - Vec3(31.20, 0.27, 287.13)).norm(), 1e-12);
  EXPECT_LT((file.table.torque_body_N_m[1] - Vec3(-5.06, 30.75, 0.48)).norm(), 1e-12);
  // Pushed away from the Sun; forces at one pole differ by up to 0.57 m² among azimuths.
  EXPECT_GT(mean_push_N(file.table), 19.0);
  EXPECT_LT(mean_push_N(file.table), 299.0);
  EXPECT_GT(spread_of(file.table), 1e-3);
  EXPECT_LT(spread_of(file.table), 5e-3);
  EXPECT_EQ(spread_of(single_valued(file.table)), 0.0);
}

TEST(Spad, ReadsATableOfASphereWhoseForcesPointAtTheSun) {
  PHOTORQUE_NEEDS_THIRD_PARTY("spad");
  const SpadFile file = read_spad(sample("SphericalModel.spo"));
  EXPECT_FALSE(file.has_torque);
  EXPECT_EQ(file.table.nodes(), 2701u);
  EXPECT_NEAR(mean_push_N(file.table), -8.945, 1e-12);
  for (const double elevation_deg : {-60.0, 0.0, 35.0}) {
    const TableAngles angles{elevation_deg * degree_rad, 50 * degree_rad};
    const Vec3 force = wrench_at(file.table, angles).force_N;
    EXPECT_LT((force - 8.945 * towards_light(angles)).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace photorque
