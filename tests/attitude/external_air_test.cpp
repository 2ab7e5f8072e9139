#include "attitude/disturbances/air/external_air.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr Air air;  // 20 °C, 1013.25 hPa
constexpr double one_rpm_rad_s = 2 * pi / 60;

AirPart disc(double radius_m) {
  return {.name = "disc", .shape = AirShape::disc, .radius_m = radius_m};
}

double torque_N_m(const AirPart& part, double rate_rad_s) {
  return air_coefficients(part, air).torque_N_m(rate_rad_s);
}

TEST(ExternalAir, WithoutAirThereIsNoDrag) {
  const Air none{.density_kg_m3 = 0.0};
  AirPart part{.radius_m = 0.1,
               .length_m = 0.2,
               .area_m2 = 0.1,
               .distance_m = 0.3,
               .inner_m = 0.1,
               .outer_m = 0.4};
  for (const AirShape shape :
       {AirShape::disc, AirShape::plate, AirShape::swept_plate, AirShape::sphere,
        AirShape::radial_cylinder, AirShape::upright_cylinder, AirShape::blunt_face}) {
    part.shape = shape;
    EXPECT_EQ(air_coefficients(part, none).torque_N_m(2.0), 0.0) << static_cast<int>(shape);
  }
}

TEST(ExternalAir, OneFaceOfADiscHasHalfTheTorque) {
  AirPart one_face = disc(0.25);
  one_face.faces = 1;
  EXPECT_DOUBLE_EQ(torque_N_m(one_face, 1.0), 0.5 * torque_N_m(disc(0.25), 1.0));
}

// The torque as the sum of Blasius' local wall stress 0.332 ρ v²/√Re_x over both faces.
TEST(ExternalAir, SweptPlateSumsTheLocalWallStress) {
  const AirPart plate{
      .shape = AirShape::swept_plate, .length_m = 0.2, .inner_m = 0.1, .outer_m = 0.4};
  const double rate = 0.8, nu = air.kinematic_viscosity_m2_s();
  double sum_N_m = 0.0;
  constexpr int across = 400, along = 400;
  for (int i = 0; i < across; ++i) {
    const double r = 0.1 + 0.3 * (i + 0.5) / across, v = rate * r;
    for (int j = 0; j < along; ++j) {
      // The substitution x = l u² removes the square-root singularity at the leading edge.
      const double u = (j + 0.5) / along, x = 0.2 * u * u, dx = 0.4 * u / along;
      const double stress_Pa = 0.332 * air.density_kg_m3 * v * v / std::sqrt(v * x / nu);
      sum_N_m += 2 * stress_Pa * dx * (0.3 / across) * r;
    }
  }
  EXPECT_NEAR(torque_N_m(plate, rate) / sum_N_m, 1.0, 1e-4);
}

TEST(ExternalAir, NarrowSweptPlateIsThePlateAtItsDistance) {
  const AirPart swept{
      .shape = AirShape::swept_plate, .length_m = 0.1, .inner_m = 0.299, .outer_m = 0.301};
  const AirPart plate{
      .shape = AirShape::plate, .length_m = 0.1, .area_m2 = 0.1 * 0.002, .distance_m = 0.3};
  EXPECT_NEAR(torque_N_m(plate, 1.0) / torque_N_m(swept, 1.0), 1.0, 1e-4);
}

TEST(ExternalAir, SphereHasTheQuotedMomentCoefficients) {
  AirPart ball{.shape = AirShape::sphere, .radius_m = 0.15};
  const double rate = 0.5, R = 0.15;
  const double eq21 = 2.93 * std::sqrt(air.viscosity_Pa_s * air.density_kg_m3) * std::pow(R, 4) *
                      std::pow(rate, 1.5);
  EXPECT_NEAR(torque_N_m(ball, rate) / eq21, 1.0, 1e-12);
  ball.moment_coefficient = 3.27;
  const double reynolds = rate * R * R / air.kinematic_viscosity_m2_s();
  const double quoted =
      6.54 / std::sqrt(reynolds) * 0.5 * air.density_kg_m3 * rate * rate * std::pow(R, 5);
  EXPECT_NEAR(torque_N_m(ball, rate) / quoted, 1.0, 1e-12);
}

// Eq. 22 compared with the sum of slices, each with drag ½ ρ c_d 2R dx (ω x)² at its arm.
TEST(ExternalAir, RadialCylinderIsTheSumOfItsSlices) {
  const AirPart cylinder{.shape = AirShape::radial_cylinder,
                         .radius_m = 0.02,
                         .length_m = 0.3,
                         .inner_m = 0.1,
                         .drag_coefficient = 1.2};
  double sum_N_m = 0.0;
  constexpr int slices = 2000;
  for (int i = 0; i < slices; ++i) {
    const double x = 0.1 + 0.3 * (i + 0.5) / slices;
    sum_N_m += 0.5 * air.density_kg_m3 * 1.2 * 0.04 * (0.3 / slices) * x * x * x;
  }
  EXPECT_NEAR(torque_N_m(cylinder, 1.0) / sum_N_m, 1.0, 1e-6);
}

// Far from the axis, neither the orientation of a short cylinder nor its shape matters.
TEST(ExternalAir, BluntPartsAgreeFarFromTheAxis) {
  const AirPart radial{.shape = AirShape::radial_cylinder,
                       .radius_m = 0.01,
                       .length_m = 0.02,
                       .inner_m = 9.99,
                       .drag_coefficient = 1.1};
  const AirPart upright{.shape = AirShape::upright_cylinder,
                        .radius_m = 0.01,
                        .length_m = 0.02,
                        .distance_m = 10.0,
                        .drag_coefficient = 1.1};
  const AirPart face{.shape = AirShape::blunt_face,
                     .area_m2 = 0.02 * 0.02,
                     .distance_m = 10.0,
                     .drag_coefficient = 1.1};
  EXPECT_NEAR(torque_N_m(radial, 1.0) / torque_N_m(upright, 1.0), 1.0, 1e-5);
  EXPECT_DOUBLE_EQ(torque_N_m(face, 1.0), torque_N_m(upright, 1.0));
}

// The printed equation contains a misprinted viscosity: the ratio is √ρ.
TEST(ExternalAir, PublishedFormDiffersByTheMisprintedViscosity) {
  const double ratio = disc_torque_as_published(disc(0.3), air, 1.0) / torque_N_m(disc(0.3), 1.0);
  EXPECT_NEAR(ratio, std::sqrt(air.density_kg_m3), 5e-3);  // 1.94 for π·0.6159 = 1.935
}

TEST(ExternalAir, FlagsWhereALawEnds) {
  EXPECT_TRUE(air_flow(disc(0.25), air, one_rpm_rad_s).laminar_law_holds());
  EXPECT_NEAR(air_flow(disc(0.25), air, one_rpm_rad_s).reynolds, 434.7, 0.5);
  EXPECT_FALSE(air_flow(disc(0.25), air, 100.0).laminar_law_holds());
  EXPECT_FALSE(air_flow(disc(0.05), air, one_rpm_rad_s).laminar_law_holds());
}

TEST(ExternalAir, TableSharesSumToOne) {
  const Table table = air_table({disc(0.2), disc(0.3)}, air, one_rpm_rad_s);
  ASSERT_EQ(table.columns.size(), 6u);
  EXPECT_NEAR(table.columns[3].values[0] + table.columns[3].values[1], 1.0, 1e-12);
}

}  // namespace
}  // namespace photorque
