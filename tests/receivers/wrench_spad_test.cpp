#include <gmock/gmock.h>

#include <sstream>

#include "receiver_scenes.h"
#include "receivers/wrench/spad.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;

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

// The numbers of the rows of a file, in its order: directions with azimuth outermost.
std::vector<std::vector<double>> rows_of(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text.substr(text.find("Record count")));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double number = 0.0; words >> number;) row.push_back(number);
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

TEST(Spad, RowsHoldTheTableToTwelveDigits) {
  for (const bool with_torque : {false, true}) {
    const WrenchTable table = sample_table(with_torque);
    const std::string text = format_spad({"body", table, with_torque}, "photorque 1: a.toml:12ab");
    EXPECT_THAT(text, HasSubstr("System             : body\n"));
    EXPECT_THAT(text, HasSubstr("(0.25, -0.5, 0.333333333333)"));
    const auto rows = rows_of(text);
    ASSERT_EQ(rows.size(), table.nodes());
    for (size_t i = 0; i < rows.size(); ++i) {
      const std::vector<double>& row = rows[i];
      ASSERT_EQ(row.size(), with_torque ? 10u : 5u);
      const size_t elevations = table.polar_rad.size();
      EXPECT_NEAR(row[0] * degree_rad, table.around_rad[i / elevations], 1e-12);
      EXPECT_NEAR(row[1] * degree_rad, table.polar_rad[i % elevations], 1e-12);
      EXPECT_LT((Vec3(row[2], row[3], row[4]) - table.force_body_N[i]).norm(), 1e-14);
      if (!with_torque) continue;
      EXPECT_NEAR(row[5], table.force_body_N[i].norm(), 1e-14);
      EXPECT_LT((Vec3(row[6], row[7], row[8]) - table.torque_body_N_m[i]).norm(), 1e-16);
      EXPECT_NEAR(row[9], table.torque_body_N_m[i].norm(), 1e-16);
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
  const auto rows = rows_of(format_spad({"body", noisy, true}, "test"));
  ASSERT_EQ(rows.size(), noisy.nodes());
  const size_t elevations = noisy.polar_rad.size();
  const auto force = [&](size_t around, size_t polar) {
    const std::vector<double>& row = rows[around * elevations + polar];
    return Vec3(row[2], row[3], row[4]);
  };
  for (size_t around = 0; around < noisy.around_rad.size(); ++around) {
    EXPECT_EQ(force(around, 0), force(0, 0));
    EXPECT_EQ(force(around, elevations - 1), force(0, elevations - 1));
  }
  for (size_t polar = 0; polar < elevations; ++polar) {
    EXPECT_EQ(force(noisy.around_rad.size() - 1, polar), force(0, polar));
  }
}

TEST(Spad, OnlyTheWholeSphereIsWritten) {
  WrenchTable tilts = make_wrench_table(WrenchTable::Angles::tilt_heading, {0.0, 0.1}, {0.0});
  EXPECT_THROW(format_spad({"body", tilts, true}, "test"), InputError);
  WrenchTable half =
      make_wrench_table(WrenchTable::Angles::azimuth_elevation, {0.0, pi / 2}, {-pi, 0.0, pi});
  EXPECT_THROW(format_spad({"body", half, true}, "test"), InputError);
}

}  // namespace
}  // namespace photorque
