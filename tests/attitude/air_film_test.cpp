#include "attitude/disturbances/bearing/air_film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/constants.h"
#include "core/errors.h"
#include "tests/outside.h"

namespace photorque {
namespace {

constexpr double ambient_Pa = 101325.0;
const FilmAir room;

// The pad of the measurements: a porous disc of 37 mm, its permeability from ONE measured flow,
// 0.849 L/min at 0.4 MPa gauge and 5.343 µm. Everything else below is prediction.
const PorousPad measured_pad{18.5e-3, 3.953e-13};

double litres_per_minute(double flow_kg_s) {
  const double density_kg_m3 = ambient_Pa / (287.05 * 293.15);
  return flow_kg_s / density_kg_m3 * 6e4;
}

struct Measured {
  double gauge_Pa, gap_m, value;
};

const char* const measured_bearing = "reference/porous_circular_air_bearing_measured.csv";

std::vector<Measured> measured(const std::string& wanted) {
  std::ifstream file(outside::third_party(measured_bearing));
  std::vector<Measured> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream in(line);
    std::string supply, gap, quantity, value;
    std::getline(in, supply, ',');
    std::getline(in, gap, ',');
    std::getline(in, quantity, ',');
    std::getline(in, value, ',');
    if (quantity == wanted)
      rows.push_back({std::stod(supply) * 1e6, std::stod(gap) * 1e-6, std::stod(value)});
  }
  return rows;
}

TEST(PorousPad, PermeabilityComesFromOneMeasuredFlow) {
  const FilmState film = porous_pad_film(measured_pad, 5.343e-6, 0.4e6 + ambient_Pa, room);
  EXPECT_NEAR(litres_per_minute(film.flow_kg_s), 0.849, 1e-3);
}

// Films thicker than 9 µm at the lowest pressure carry more than predicted (up to half as much
// again): the pad's edge, and a zero of the gap that is known to about 1 µm.
TEST(PorousPad, PredictsMeasuredLoads) {
  PHOTORQUE_NEEDS_THIRD_PARTY(measured_bearing);
  const std::vector<Measured> loads = measured("load");
  double sum = 0.0;
  int rows = 0;
  for (const Measured& row : loads) {
    if (row.gap_m > 9e-6) continue;
    const double ours_N =
        porous_pad_film(measured_pad, row.gap_m, row.gauge_Pa + ambient_Pa, room).load_N;
    EXPECT_NEAR(ours_N / row.value, 1.0, 0.17) << row.gauge_Pa << " Pa, " << row.gap_m << " m";
    sum += std::abs(ours_N / row.value - 1.0);
    ++rows;
  }
  EXPECT_GE(rows, 26);
  EXPECT_LT(sum / rows, 0.08);
}

TEST(PorousPad, PredictsMeasuredStiffness) {
  PHOTORQUE_NEEDS_THIRD_PARTY(measured_bearing);
  const std::vector<Measured> rows = measured("stiffness");
  for (const Measured& row : rows) {
    if (row.gap_m > 8e-6) continue;
    const auto load_N = [&](double gap_m) {
      return porous_pad_film(measured_pad, gap_m, row.gauge_Pa + ambient_Pa, room).load_N;
    };
    const double stiffness_N_um =
        (load_N(row.gap_m - 1e-8) - load_N(row.gap_m + 1e-8)) / 2e-8 * 1e-6;
    EXPECT_NEAR(stiffness_N_um / row.value, 1.0, 0.25)
        << row.gauge_Pa << " Pa, " << row.gap_m << " m";
  }
}

TEST(PorousPad, PredictsMeasuredFlowsAtMiddlingGaps) {
  PHOTORQUE_NEEDS_THIRD_PARTY(measured_bearing);
  const std::vector<Measured> rows = measured("flow");
  for (const Measured& row : rows) {
    if (row.gap_m < 3.5e-6 || row.gap_m > 9e-6) continue;
    const FilmState film =
        porous_pad_film(measured_pad, row.gap_m, row.gauge_Pa + ambient_Pa, room);
    EXPECT_NEAR(litres_per_minute(film.flow_kg_s) / row.value, 1.0, 0.25) << row.gauge_Pa;
  }
}

// Without restriction the pad is a piston; without supply it carries nothing.
TEST(PorousPad, LimitsAreThePistonAndNothing) {
  const double area_m2 = pi * measured_pad.radius_m * measured_pad.radius_m;
  const FilmState closed = porous_pad_film(measured_pad, 1e-8, 5e5, room);
  EXPECT_NEAR(closed.load_N / ((5e5 - ambient_Pa) * area_m2), 1.0, 2e-3);
  EXPECT_NEAR(porous_pad_film(measured_pad, 5e-6, ambient_Pa, room).load_N, 0.0, 1e-9);
}

// The pad's supply through its whole face equals the outflow at its rim: Darcy's law integrated
// over the pressure profile, against the rim's Bessel slope.
TEST(PorousPad, WhatSeepsInFlowsOut) {
  const double gap_m = 6e-6, supply_Pa = 5e5;
  double seeping_kg_s = 0.0;
  constexpr int rings = 20000;
  for (int i = 0; i < rings; ++i) {
    const double r = (i + 0.5) * measured_pad.radius_m / rings;
    const double p = porous_pad_pressure_Pa(measured_pad, gap_m, supply_Pa, room, r);
    seeping_kg_s += measured_pad.permeability_per_thickness_m * (supply_Pa * supply_Pa - p * p) /
                    (2 * room.viscosity_Pa_s * 287.05 * room.temperature_K) * 2 * pi * r *
                    measured_pad.radius_m / rings;
  }
  EXPECT_NEAR(porous_pad_film(measured_pad, gap_m, supply_Pa, room).flow_kg_s / seeping_kg_s, 1.0,
              1e-6);
}

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

// A wide film leaves the hole choked: 0.0404 Cd A p / √T for air (White, eq. 9.46c), whatever
// lies downstream.
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

// The stiffness at the rated load, continued as a spring, opens the gap far less than the film
// opens: this is why a catalogue's stiffness cannot be used to unload a bearing.
TEST(OrificeFilm, UnloadedFilmIsThickerThanTheSpringPredicts) {
  const double rated_N = 250.0, unloaded_N = 10.0;
  const double rated_m = gap_under_load_m(fed_socket(), feed, room, rated_N);
  const double nearby_m = gap_under_load_m(fed_socket(), feed, room, 1.01 * rated_N);
  const double stiffness_N_m = 0.01 * rated_N / (rated_m - nearby_m);
  const double film_m = gap_under_load_m(fed_socket(), feed, room, unloaded_N);
  EXPECT_GT(film_m, 1.3 * spring_gap_m(rated_m, rated_N, stiffness_N_m, unloaded_N));
}

TEST(OrificeFilm, RefusesWhatCannotBeCarried) {
  EXPECT_THROW(gap_under_load_m(fed_socket(), feed, room, 1e4), NumericalError);
  SphericalSocket no_recess = fed_socket();
  no_recess.recess_half_angle_rad = 0.0;
  EXPECT_THROW(orifice_fed_film(no_recess, feed, room), NumericalError);
  EXPECT_THROW(orifice_fed_film(fed_socket(), {1e5, 2e-8, 0.8}, room), NumericalError);
}

}  // namespace
}  // namespace photorque
