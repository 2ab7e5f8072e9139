#include "attitude/environment/igrf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "core/constants.h"
#include "core/errors.h"
#include "tests/outside.h"

namespace photorque {
namespace {

constexpr double nT = 1e-9;

// Decimal year, height above the ellipsoid [km], geodetic colatitude and east longitude [deg], then
// X, Y, Z [nT], as printed by the original Fortran program igrf14syn.
struct GeodeticRow {
  double year, height_km, colatitude_deg, longitude_deg;
  Vec3 north_east_down_nT;
};

double difference_nT(const GeodeticRow& row) {
  const GeodeticPosition position{(90.0 - row.colatitude_deg) * degree_rad,
                                  row.longitude_deg * degree_rad, row.height_km * 1e3};
  const Vec3 ours_nT = GeomagneticModel(row.year).north_east_down_T(position) / nT;
  return (ours_nT - row.north_east_down_nT).cwiseAbs().maxCoeff();
}

TEST(Igrf, AgreesWithTheReferenceProgramAtAHandfulOfPlaces) {
  const GeodeticRow rows[] = {
      {1900.0, 232.32, 68.00, 165.11, {27505.75351, 3089.91355, 16985.87684}},
      {1971.9, 372.19, 4.23, 244.39, {-1032.48029, 117.36753, 48759.11091}},
      {1985.4, 1232.12, 89.19, 131.52, {21664.23307, 807.92095, -6610.42391}},
      {1912.3, 461.20, 0.27, 149.15, {5.54379, 2869.14288, 47029.33285}},
      {2022.1, 829.10, 46.47, 114.85, {17590.40262, -1731.07191, 33147.28408}},
      {2028.4, 1034.24, 39.54, 296.89, {10825.08139, -2737.49034, 31481.89119}},
      {2034.9, 1443.58, 20.99, 110.28, {5027.13319, -473.47396, 32362.42054}},
  };
  for (const GeodeticRow& row : rows) EXPECT_LT(difference_nT(row), 0.1) << row.year;
}

// The rows' own rounding is 0.02 nT: coordinates are printed to 0.01 km and 0.01 deg and are exact.
TEST(Igrf, AgreesWithEveryGeodeticReferenceRow) {
  const char* const name = "reference/igrf14_geodetic.txt";
  PHOTORQUE_NEEDS_THIRD_PARTY(name);
  std::ifstream file(outside::third_party(name));
  int rows = 0;
  double worst_nT = 0.0;
  for (std::string line; std::getline(file, line); ++rows) {
    std::istringstream in(line);
    GeodeticRow row{};
    in >> row.year >> row.height_km >> row.colatitude_deg >> row.longitude_deg >>
        row.north_east_down_nT.x() >> row.north_east_down_nT.y() >> row.north_east_down_nT.z();
    ASSERT_FALSE(in.fail()) << line;
    worst_nT = std::max(worst_nT, difference_nT(row));
  }
  EXPECT_GE(rows, 1000);
  EXPECT_LT(worst_nT, 0.1);
  RecordProperty("worst_nT", std::to_string(worst_nT));
}

// Geocentric rows of the same program: no ellipsoid, so the agreement is limited by its printing of
// the coefficients in single precision.
TEST(Igrf, AgreesWithGeocentricReferenceRows) {
  struct Row {
    double year, radius_km, colatitude_deg, longitude_deg;
    Vec3 north_east_down_nT;
  };
  const Row rows[] = {
      {2022.1, 7207.24, 46.47, 114.85, {17343.43338, -1717.75319, 33139.75721}},
      {2027.9, 7056.50, 11.81, 318.83, {4129.33531, -1674.48924, 41472.74462}},
      {2019.0, 7103.56, 42.08, 290.39, {12117.03991, -3087.94546, 36194.31649}},
  };
  for (const Row& row : rows) {
    const GeocentricPosition position{row.radius_km * 1e3, row.colatitude_deg * degree_rad,
                                      row.longitude_deg * degree_rad};
    const Vec3 ours_nT = GeomagneticModel(row.year).north_east_down_T(position) / nT;
    EXPECT_LT((ours_nT - row.north_east_down_nT).cwiseAbs().maxCoeff(), 0.015) << row.year;
  }
}

// Maxwell: outside its sources the field has neither divergence nor curl, checked by differences in
// Cartesian axes around a point, which mixes all three components and both angles.
TEST(Igrf, FieldHasNeitherDivergenceNorCurl) {
  const GeomagneticModel model(2026.3);
  const auto field_T = [&](const Vec3& p) -> Vec3 {
    const double r = p.norm(), theta = std::acos(p.z() / r), phi = std::atan2(p.y(), p.x());
    const Vec3 ned = model.north_east_down_T(GeocentricPosition{r, theta, phi});
    const Vec3 up = p / r, east(-std::sin(phi), std::cos(phi), 0.0), north = up.cross(east);
    return ned.x() * north + ned.y() * east - ned.z() * up;
  };
  const Vec3 point(4.1e6, -2.3e6, 4.9e6);
  const double step_m = 1e3;
  Mat3 gradient;
  for (int k = 0; k < 3; ++k) {
    const Vec3 step = step_m * Vec3::Unit(k);
    gradient.col(k) = (field_T(point + step) - field_T(point - step)) / (2.0 * step_m);
  }
  const double size = gradient.norm();
  EXPECT_LT(std::abs(gradient.trace()), 1e-6 * size);
  EXPECT_LT((gradient - gradient.transpose()).norm(), 1e-6 * size);
}

// At the pole the horizontal field is one vector for all meridians.
TEST(Igrf, HorizontalFieldAtThePoleIsOneVector) {
  const GeomagneticModel model(2026.0);
  const auto in_polar_plane = [&](double longitude_rad) -> Vec2 {
    const Vec3 ned = model.north_east_down_T(GeocentricPosition{6.4e6, 0.0, longitude_rad});
    // North points towards the pole from longitude λ, so it runs along −(cos λ, sin λ).
    const Vec2 outward(std::cos(longitude_rad), std::sin(longitude_rad));
    return -ned.x() * outward + ned.y() * Vec2(-outward.y(), outward.x());
  };
  const Vec2 reference = in_polar_plane(0.0);
  EXPECT_GT(reference.norm(), 100 * nT);
  for (const double longitude : {0.7, 2.1, 4.4})
    EXPECT_LT((in_polar_plane(longitude) - reference).norm(), 1e-6 * nT);
}

TEST(Igrf, LabAxesAreEastNorthUp) {
  const GeodeticPosition milan{45.5 * degree_rad, 9.15 * degree_rad, 120.0};
  const Vec3 lab_T = GeomagneticModel(2026.0).lab_T(milan);
  EXPECT_GT(lab_T.y(), 2e-5);   // the compass points north
  EXPECT_LT(lab_T.z(), -4e-5);  // and dips in the northern hemisphere
  EXPECT_LT(std::abs(lab_T.x()), 3e-6);
}

TEST(Igrf, RefusesYearsWithoutCoefficients) {
  EXPECT_THROW(GeomagneticModel(1899.9), NumericalError);
  EXPECT_THROW(GeomagneticModel(2035.1), NumericalError);
  EXPECT_THROW(GeomagneticModel(std::nan("")), NumericalError);
}

// The table in the program compared with the official release, number by number.
TEST(Igrf, CommittedCoefficientsAreTheOfficialOnes) {
  const char* const name = "reference/igrf14coeffs.txt";
  PHOTORQUE_NEEDS_THIRD_PARTY(name);
  std::ifstream official(outside::third_party(name));
  std::ifstream committed(std::filesystem::path(PHOTORQUE_SOURCE_DIR) /
                          "attitude/environment/igrf14_coefficients.inc");
  ASSERT_TRUE(committed);
  const auto next_row = [&] {
    std::string line;
    while (std::getline(committed, line) && !line.starts_with('{')) {
    }
    for (char& c : line)
      if (c == '{' || c == '}' || c == ',') c = ' ';
    return line;
  };
  int rows = 0;
  for (std::string line; std::getline(official, line);) {
    if (!line.starts_with("g ") && !line.starts_with("h ")) continue;
    std::istringstream theirs(line), ours(next_row());
    char letter = 0;
    std::string is_h;
    theirs >> letter;
    ours >> is_h;
    ASSERT_EQ(is_h == "true", letter == 'h');
    int numbers = 0;
    for (double a = 0, b = 0; theirs >> a; ++numbers) {
      ASSERT_TRUE(ours >> b) << line;
      ASSERT_EQ(a, b) << line;
    }
    EXPECT_EQ(numbers, 2 + 26 + 1);
    ++rows;
  }
  EXPECT_EQ(rows, 13 * 15);
}

// The degree-1 part dominates far away: at 60 Earth radii the full model and its own dipole agree.
TEST(DipoleField, IsTheFarLimitOfTheFullModel) {
  const double radius_m = 60 * 6371.2e3;
  // IGRF-14 at 2025.0: dipole moment from g11, h11, g10.
  const Vec3 dipole_nT(-1410.3, 4545.5, -29350.0);
  const double equatorial_T = dipole_nT.norm() * nT;
  EXPECT_NEAR(GeomagneticModel(2025.0).dipole_equatorial_field_T(), equatorial_T, 1e-15);
  const Vec3 axis = -dipole_nT.normalized();
  const double theta = 1.1, phi = 0.4;
  const Vec3 up(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  const double full_T =
      GeomagneticModel(2025.0).north_east_down_T(GeocentricPosition{radius_m, theta, phi}).norm();
  // Field of a dipole: equatorial field · (R/r)³ √(1 + 3 cos²) of the magnetic colatitude.
  const double cosine = axis.dot(up);
  const double dipole_T = equatorial_T / std::pow(60.0, 3) * std::sqrt(1.0 + 3.0 * cosine * cosine);
  EXPECT_NEAR(full_T / dipole_T, 1.0, 5e-3);
}

}  // namespace
}  // namespace photorque
