#include "attitude/disturbances/bearing/air_bearing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/transform.h"

namespace photorque {
namespace {

constexpr double bar = 1e5;

// Sums over small patches of a cap by the 2-D midpoint rule, with geometry independent of the
// tested code.
struct CapSums {
  double vertical_force_N = 0.0;
  Mat3 drag_N_m_s = Mat3::Zero();
};

CapSums sum_over_cap(const SphericalSocket& socket, double inlet_Pa, double ambient_Pa,
                     double viscosity_Pa_s) {
  constexpr int rings = 4000, sectors = 24;
  CapSums sums;
  const double step = socket.half_angle_rad / rings;
  for (int i = 0; i < rings; ++i) {
    const double theta = (i + 0.5) * step;
    const bool in_recess = theta < socket.recess_half_angle_rad;
    const double fallen = in_recess ? 0.0
                                    : (theta - socket.recess_half_angle_rad) /
                                          (socket.half_angle_rad - socket.recess_half_angle_rad);
    const double gauge_Pa = (inlet_Pa - ambient_Pa) * (1.0 - fallen);
    const double patch_m2 =
        socket.radius_m * socket.radius_m * std::sin(theta) * step * 2 * pi / sectors;
    for (int j = 0; j < sectors; ++j) {
      const double phi = 2 * pi * j / sectors;
      const Vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                   -std::cos(theta));
      sums.vertical_force_N += gauge_Pa * patch_m2 * -n.z();
      if (in_recess) continue;
      for (int k = 0; k < 3; ++k) {
        const Vec3 point_m = socket.radius_m * n;
        const Vec3 stress_Pa = -viscosity_Pa_s * Vec3::Unit(k).cross(point_m) / socket.gap_m;
        sums.drag_N_m_s.col(k) -= point_m.cross(stress_Pa) * patch_m2;
      }
    }
  }
  return sums;
}

TEST(AirBearing, LoadIsTheProjectedGaugePressureSummedOverTheSocket) {
  for (const double half_angle_deg : {30.0, 45.0, 90.0}) {
    for (const double recess_deg : {0.0, 9.0}) {
      const SphericalSocket socket{0.03, half_angle_deg * degree_rad, 5e-6,
                                   recess_deg * degree_rad};
      const double summed_N = sum_over_cap(socket, 5 * bar, 1 * bar, 1.8e-5).vertical_force_N;
      EXPECT_NEAR(load_capacity_N(socket, 5 * bar, 1 * bar) / summed_N, 1.0, 1e-4);
    }
  }
}

// With a recess of nearly the whole socket, the load is the gauge pressure times the area of the
// opening.
TEST(AirBearing, AllRecessCarriesLikeAPiston) {
  const SphericalSocket socket{0.03, 0.7, 5e-6, 0.7 - 1e-7};
  const double opening_m2 = pi * std::pow(0.03 * std::sin(0.7), 2);
  EXPECT_NEAR(load_capacity_N(socket, 3 * bar, 1 * bar) / (2 * bar * opening_m2), 1.0, 1e-6);
}

TEST(AirBearing, CarriesNothingWithoutGaugePressure) {
  EXPECT_EQ(load_capacity_N({0.03, 0.7, 5e-6}, bar, bar), 0.0);
}

// The two forms of eq. 7 differ by the factor found by numerical integration, 2.0 to 2.7.
TEST(AirBearing, PublishedLoadIsTwiceTheProjectedGaugeLoad) {
  const double inlet_Pa = 0.85 * 5 * bar;
  const auto ratio = [&](double half_angle_deg) {
    const SphericalSocket socket{0.03, half_angle_deg * degree_rad, 5e-6};
    return load_capacity_as_published_N(socket, inlet_Pa, bar) /
           load_capacity_N(socket, inlet_Pa, bar);
  };
  EXPECT_NEAR(ratio(30.0), 2.0, 0.05);
  EXPECT_NEAR(ratio(90.0), 2.7, 0.05);
}

// A published Fluent study of a socket of 80 mm diameter at 1 bar gauge with one central and twelve
// outer holes: 279 N (T. Ahmet, Numerical analysis of a low-cost spherical air bearing for CubeSat
// ADCS testing). One hole with a linear pressure drop must carry less, but at least 80 % of that.
TEST(AirBearing, CarriesTheOrderOfAPublishedSimulation) {
  const SphericalSocket hemisphere{0.04, pi / 2, 100e-6};
  const double load_N = load_capacity_N(hemisphere, 2.01325 * bar, 1.01325 * bar);
  EXPECT_LT(load_N, 279.0);
  EXPECT_GT(load_N, 0.8 * 279.0);
}

TEST(AirBearing, DragTensorIsTheSumOverTheFilm) {
  for (const double recess_rad : {0.0, 0.2}) {
    const SphericalSocket socket{0.0317, 0.9, 5e-6, recess_rad};
    const Mat3 summed = sum_over_cap(socket, bar, bar, 1.8e-5).drag_N_m_s;
    const FilmDrag drag = film_drag(socket, 1.8e-5);
    EXPECT_NEAR(drag.axial_N_m_s / summed(2, 2), 1.0, 1e-3);
    EXPECT_NEAR(drag.transverse_N_m_s / summed(0, 0), 1.0, 1e-3);
    EXPECT_NEAR(drag.transverse_N_m_s / summed(1, 1), 1.0, 1e-3);
  }
}

// Viscous torque of a cap about its axis: μ ω (2πR⁴/h)(2/3 − cos a + cos³a/3), the textbook form;
// the paper's eq. 17 writes the same with cos 3a.
TEST(AirBearing, AxialDragIsTheTextbookCap) {
  const double a = 0.6, R = 0.03, h = 7e-6, mu = 1.8e-5;
  const double cap =
      2 * pi * std::pow(R, 4) / h * mu * (2.0 / 3 - std::cos(a) + std::pow(std::cos(a), 3) / 3);
  const double eq17 = pi * std::pow(R, 4) * mu / (6 * h) * (std::cos(3 * a) - 9 * std::cos(a) + 8);
  EXPECT_NEAR(film_drag({R, a, h}, mu).axial_N_m_s / cap, 1.0, 1e-12);
  EXPECT_NEAR(film_drag({R, a, h}, mu).axial_N_m_s / eq17, 1.0, 1e-12);
}

// Two whole spheres: no axis is special, and 8π μ R₁³R₂³/(R₂³ − R₁³) is exact (Landau and Lifshitz,
// Fluid Mechanics, § 20, problem 2, for a resting outer sphere).
TEST(AirBearing, WholeSphereDragsAsConcentricSpheresDo) {
  const double R = 0.05, h = 1e-3, mu = 1.8e-5;
  const FilmDrag drag = film_drag({R, pi, h}, mu);
  EXPECT_NEAR(drag.axial_N_m_s / drag.transverse_N_m_s, 1.0, 1e-12);
  const double inner3 = std::pow(R, 3), outer3 = std::pow(R + h, 3);
  const double exact = 8 * pi * mu * inner3 * outer3 / (outer3 - inner3);
  // The model assumes a plane film; the curvature of the shells gives this factor, 1 + 2 h/R + …
  const double curvature = 3.0 * h * outer3 / (R * (outer3 - inner3));
  EXPECT_NEAR(drag.axial_N_m_s * curvature / exact, 1.0, 1e-12);
}

TEST(AirBearing, GroovesTakeTheirShareOfTheDrag) {
  const SphericalSocket plain{0.03, 0.8, 5e-6};
  SphericalSocket grooved = plain;
  grooved.sheared_fraction = 0.4;
  EXPECT_DOUBLE_EQ(film_drag(grooved, 1.8e-5).axial_N_m_s,
                   0.4 * film_drag(plain, 1.8e-5).axial_N_m_s);
}

TEST(AirBearing, SpringGapOpensAsTheLoadFallsAndNeverCloses) {
  EXPECT_DOUBLE_EQ(spring_gap_m(5e-6, 300.0, 5e7, 300.0), 5e-6);
  EXPECT_DOUBLE_EQ(spring_gap_m(5e-6, 300.0, 5e7, 50.0), 10e-6);
  EXPECT_EQ(spring_gap_m(5e-6, 300.0, 5e7, 900.0), 0.0);
}

constexpr double ambient_Pa = 101325.0;
const FilmAir room;

SphericalSocket fed_socket() {
  return {0.0317, 45 * degree_rad, 5e-6, 6 * degree_rad};
}
constexpr OrificeFeed feed{6.5e5, 2e-8, 0.8};

TEST(OrificeFilm, ThinFilmTakesTheWholeSupplyAndThickFilmNone) {
  SphericalSocket socket = fed_socket();
  socket.gap_m = 1e-7;
  EXPECT_NEAR(orifice_fed_film(socket, feed, room).inlet_Pa / feed.supply_Pa, 1.0, 1e-3);
  socket.gap_m = 3e-4;
  EXPECT_NEAR(orifice_fed_film(socket, feed, room).inlet_Pa / ambient_Pa, 1.0, 1e-2);
}

// With a wide film the flow through the hole is choked: 0.0404 Cd A p / √T for air (White, eq.
// 9.46c), independent of the pressure downstream.
TEST(OrificeFilm, WideFilmIsFedByChokedFlow) {
  SphericalSocket socket = fed_socket();
  socket.gap_m = 3e-4;
  const double choked_kg_s = 0.6847 * feed.discharge_coefficient * feed.hole_area_m2 *
                             feed.supply_Pa / std::sqrt(287.05 * room.temperature_K);
  EXPECT_NEAR(orifice_fed_film(socket, feed, room).flow_kg_s / choked_kg_s, 1.0, 1e-4);
}

TEST(OrificeFilm, GapUnderLoadInvertsTheLoad) {
  SphericalSocket socket = fed_socket();
  double thicker_m = 1.0;
  for (const double load_N : {50.0, 100.0, 200.0}) {
    socket.gap_m = gap_under_load_m(fed_socket(), feed, room, load_N);
    EXPECT_NEAR(orifice_fed_film(socket, feed, room).load_N, load_N, 1e-6 * load_N);
    EXPECT_LT(socket.gap_m, thicker_m);
    thicker_m = socket.gap_m;
  }
}

// The film opens much more than a spring with the stiffness at the rated load. The stiffness in a
// catalogue therefore does not predict the gap of an unloaded bearing.
TEST(OrificeFilm, UnloadedFilmIsThickerThanTheSpringPredicts) {
  const double rated_N = 250.0, unloaded_N = 10.0;
  const double rated_m = gap_under_load_m(fed_socket(), feed, room, rated_N);
  const double nearby_m = gap_under_load_m(fed_socket(), feed, room, 1.01 * rated_N);
  const double stiffness_N_m = 0.01 * rated_N / (rated_m - nearby_m);
  const double film_m = gap_under_load_m(fed_socket(), feed, room, unloaded_N);
  EXPECT_GT(film_m, 1.3 * spring_gap_m(rated_m, rated_N, stiffness_N_m, unloaded_N));
}

TEST(OrificeFilm, RejectsUnsupportedData) {
  EXPECT_THROW(gap_under_load_m(fed_socket(), feed, room, 1e4), NumericalError);
  SphericalSocket no_recess = fed_socket();
  no_recess.recess_half_angle_rad = 0.0;
  EXPECT_THROW(orifice_fed_film(no_recess, feed, room), NumericalError);
  EXPECT_THROW(orifice_fed_film(fed_socket(), {1e5, 2e-8, 0.8}, room), NumericalError);
}

}  // namespace
}  // namespace photorque
