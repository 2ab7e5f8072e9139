#include "attitude/disturbances/bearing/air_bearing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/errors.h"

namespace photorque {
namespace {

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
