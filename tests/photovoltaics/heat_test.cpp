// Cell temperature: the heat balance of a plate against closed forms, a textbook, and SciPy.
#include "photovoltaics/array/heat.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/numerics/random.h"
#include "photovoltaics/array/array.h"
#include "photovoltaics/array/supply.h"
#include "reference.h"

namespace photorque {
namespace {

constexpr double stefan_boltzmann = 5.670374419e-8;

double nothing(double) {
  return 0.0;
}

// One face that loses heat in proportion to its excess.
CellHeat linear() {
  return {.air_K = 290.0, .convection_W_m2_K = 8.0, .emissivity = 0.0, .faces = 1};
}

// F. P. Incropera, D. P. DeWitt, Fundamentals of Heat and Mass Transfer, 6th ed., example 9.2: a
// plate of 0.71 m at 505 K in air of 296 K has Ra = 1.813e9, Nu = 147, h = 7.0 W/m²K.
TEST(CellPlate, NaturalConvectionIsThatOfTheTextbook) {
  const CellPlate plate({.air_K = 296.0, .emissivity = 0.0, .faces = 1}, 0.71 * 0.71);
  EXPECT_NEAR(plate.loss_W_m2(505.0) / (505.0 - 296.0), 7.0, 0.1);
}

TEST(CellPlate, FacesCoolEquallyAndThinAirLess) {
  CellHeat heat{.surroundings_K = 260.0};
  const double both = CellPlate(heat, 0.1).loss_W_m2(330.0);
  heat.air_pressure_Pa = 1000.0;
  EXPECT_LT(CellPlate(heat, 0.1).loss_W_m2(330.0), 0.9 * both);
  heat.air_pressure_Pa = 101325.0;
  heat.faces = 1;
  EXPECT_NEAR(CellPlate(heat, 0.1).loss_W_m2(330.0), 0.5 * both, 1e-10 * both);
}

// Power that falls by a straight line: α E − p₀ + p₁ (T − T_air) = h (T − T_air).
TEST(CellPlate, SteadyStateOfALinearPlate) {
  const CellPlate plate(linear(), 0.1);
  const double steady_K =
      plate.steady_K(500.0, [](double kelvin) { return 150.0 - 0.7 * (kelvin - 290.0); });
  EXPECT_NEAR(steady_K, 290.0 + (0.93 * 500.0 - 150.0) / (8.0 - 0.7), 1e-6);
}

// Both faces radiate the remaining heat: 2 ε σ (T⁴ − T_s⁴) = α E − p.
TEST(CellPlate, SteadyStateInAVacuum) {
  const CellPlate plate({.surroundings_K = 200.0, .convection_W_m2_K = 0.0, .emissivity = 0.8},
                        0.1);
  const double left = 0.93 * 1361.0 - 300.0;
  const double steady_K = plate.steady_K(1361.0, [](double) { return 300.0; });
  EXPECT_NEAR(steady_K, std::pow(left / (1.6 * stefan_boltzmann) + std::pow(200.0, 4), 0.25), 1e-6);
}

TEST(CellPlate, StaysWhereCellsCanBeComputed) {
  const CellPlate sky({.surroundings_K = 2.725, .convection_W_m2_K = 0.0}, 0.1);
  EXPECT_EQ(sky.steady_K(0.0, nothing), coldest_cell_K);
  EXPECT_EQ(sky.steady_K(1e7, nothing), hottest_cell_K);
  // Cells that deliver more than they absorb are no colder than their surroundings.
  const CellPlate room(CellHeat{}, 0.1);
  EXPECT_NEAR(room.steady_K(100.0, [](double) { return 1e4; }), 293.15, 1e-6);
}

TEST(CellPlate, ALinearPlateWarmsExponentially) {
  const CellPlate plate(linear(), 0.1);
  const double end_K = 290.0 + 400.0 / 8.0, time_s = 700.0;
  const CellPlate::Step step = plate.step(280.0, 400.0, time_s);
  EXPECT_NEAR(step.end_K, end_K + (280.0 - end_K) * std::exp(-time_s * 8.0 / 2000.0), 1e-9);
  EXPECT_NEAR(step.given_off_J_m2, 400.0 * time_s - 2000.0 * (step.end_K - 280.0), 1e-6);
}

// Radiation alone into the cold: d(T⁻³)/dt = 3 n ε σ/C.
TEST(CellPlate, ADarkPlateInAVacuumCoolsByItsFourthPower) {
  const CellPlate plate({.surroundings_K = 1.0, .convection_W_m2_K = 0.0, .emissivity = 0.9}, 0.1);
  const double fall = 3.0 * 2.0 * 0.9 * stefan_boltzmann / 2000.0;
  for (const double time_s : {1.0, 30.0, 2000.0}) {
    const double cooled_K = std::pow(std::pow(300.0, -3) + fall * time_s, -1.0 / 3.0);
    EXPECT_NEAR(plate.step(300.0, 0.0, time_s).end_K, cooled_K, 3e-3 * (300.0 - cooled_K));
  }
}

TEST(CellPlate, AColdPlateDoesNotOvershootInLongSteps) {
  const CellPlate plate({.surroundings_K = 3.0, .convection_W_m2_K = 0.0}, 0.1);
  const double steady_K = plate.temperature_at_loss_K(900.0);
  double kelvin = 3.0;
  for (int k = 0; k < 5; ++k) {
    kelvin = plate.step(kelvin, 900.0, 3600.0).end_K;
    EXPECT_LE(kelvin, steady_K * (1.0 + 1e-9));
  }
  EXPECT_NEAR(kelvin, steady_K, 1e-6);
}

// --- An array ---------------------------------------------------------------------------------

ArrayDesign twelve_cells(const CellHeat& heat) {
  ArrayDesign design = reference::array_in_series(3, 4, 4);
  design.heat = heat;
  return design;
}

ArrayLight even_light(double irradiance_W_m2) {
  return array_light(3, 4, 0.3, 0.4, std::vector<double>(12, irradiance_W_m2));
}

constexpr std::array responsivity_A_W{0.55};

// Made by tests/data/heat/steady.py: SciPy, with a separate cell and plate.
TEST(WarmArray, IsAtTheTemperatureThatSciPyFinds) {
  struct Case {
    const char* name;
    double irradiance_W_m2;
    CellHeat heat;
    double temperature_K, power_W, slope_W_K;
  };
  const Case cases[] = {
      {"still_air", 1000.0, {}, 324.0173740, 34.3151890, -0.138915},
      {"dim", 150.0, {}, 299.0831363, 5.3839860, -0.022218},
      {"one_face", 1000.0, {.faces = 1}, 349.2224125, 30.8259610, -0.137894},
      {"wind",
       1000.0,
       {.air_K = 308.15, .surroundings_K = 303.15, .convection_W_m2_K = 15.0},
       322.1598608,
       34.5732830,
       -0.138977},
      {"thin_air",
       1000.0,
       {.air_pressure_Pa = 5000.0, .emissivity = 0.3, .absorptance = 0.7},
       358.8090337,
       29.5063080,
       -0.137408},
      {"vacuum",
       1361.0,
       {.surroundings_K = 2.725, .convection_W_m2_K = 0.0},
       307.4522661,
       49.7435543,
       -0.187269},
  };
  for (const Case& one : cases) {
    const ArrayResult result =
        evaluate_array(twelve_cells(one.heat), even_light(one.irradiance_W_m2), responsivity_A_W);
    EXPECT_NEAR(result.temperature_K.value, one.temperature_K, 2e-6) << one.name;
    EXPECT_NEAR(result.power_W.value, one.power_W, 1e-7 * one.power_W) << one.name;
    EXPECT_NEAR(result.power_per_K_W, one.slope_W_K, 2e-6) << one.name;
  }
}

// A stated temperature is that of the cells in any light; its slope is given as well.
TEST(WarmArray, AStatedTemperatureHolds) {
  ArrayDesign design = twelve_cells({});
  const ArrayResult steady = evaluate_array(design, even_light(1000.0), responsivity_A_W);
  design.heat.reset();
  design.temperature_K = steady.temperature_K.value;
  const ArrayResult stated = evaluate_array(design, even_light(1000.0), responsivity_A_W);
  EXPECT_EQ(stated.temperature_K.value, steady.temperature_K.value);
  EXPECT_EQ(stated.temperature_K.standard_error, 0.0);
  EXPECT_NEAR(stated.power_W.value, steady.power_W.value, 1e-11);
  EXPECT_NEAR(stated.power_per_K_W, steady.power_per_K_W, 1e-9);
}

// The cells' own slopes of the photocurrent are those of the reference temperature.
TEST(WarmArray, PhotocurrentsGrowOnceOnly) {
  ArrayDesign design = twelve_cells({});
  design.cell.photocurrent_slope_1_K = 5e-4;
  const ArrayResult result = evaluate_array(design, even_light(1000.0), responsivity_A_W);
  const double factor = 1.0 + 5e-4 * (result.temperature_K.value - 298.15);
  for (const double current_A : result.cell_photocurrent_A) {
    EXPECT_NEAR(current_A, 0.55 * 1000.0 * 0.01 * factor, 1e-12);
  }
}

TEST(WarmArray, InTheDarkIsAtTheTemperatureAround) {
  const ArrayResult result = evaluate_array(twelve_cells({.air_K = 280.0, .surroundings_K = 280.0}),
                                            even_light(0.0), responsivity_A_W);
  EXPECT_NEAR(result.temperature_K.value, 280.0, 1e-6);
  EXPECT_EQ(result.power_W.value, 0.0);
}

// Replicates that differ in all of their light: power and temperature follow from one light at a
// time, which is evaluated here with a separate temperature.
TEST(WarmArray, ErrorsIncludeTheTemperature) {
  constexpr int replicates = 8;
  const ArrayDesign design = twelve_cells({.faces = 1});
  ArrayLight light = even_light(1000.0);
  light.power_W = {12, replicates, {}};
  double powers = 0.0, power_squares = 0.0, kelvins = 0.0, kelvin_squares = 0.0;
  for (uint64_t r = 0; r < replicates; ++r) {
    const double factor = 1.0 + 0.02 * (unit_interval(hash_words(5, r)) - 0.5);
    for (int b = 0; b < 12; ++b) light.power_W.sums.push_back(10.0 * factor);
    const ArrayResult one = evaluate_array(design, even_light(1000.0 * factor), responsivity_A_W);
    powers += one.power_W.value / replicates;
    power_squares += std::pow(one.power_W.value, 2) / replicates;
    kelvins += one.temperature_K.value / replicates;
    kelvin_squares += std::pow(one.temperature_K.value, 2) / replicates;
  }
  const auto error = [](double mean, double squares) {
    return std::sqrt((squares - mean * mean) / (replicates - 1.0));
  };
  const ArrayResult all = evaluate_array(design, light, responsivity_A_W);
  const double power_error_W = error(powers, power_squares);
  EXPECT_NEAR(all.power_W.standard_error / power_error_W, 1.0, 0.01);
  EXPECT_NEAR(all.temperature_K.standard_error / error(kelvins, kelvin_squares), 1.0, 0.01);
  // Cells of a fixed temperature would follow the light by a fifth more.
  ArrayDesign held = design;
  held.heat.reset();
  held.temperature_K = all.temperature_K.value;
  const ArrayResult fixed = evaluate_array(held, light, responsivity_A_W);
  EXPECT_GT(fixed.power_W.standard_error, 1.15 * power_error_W);
}

// The power system over time comes to rest where evaluate_array() has the cells.
TEST(WarmArray, APowerSystemOverTimeEndsInTheSameState) {
  for (const CellHeat& heat :
       {CellHeat{},
        CellHeat{.surroundings_K = 2.725, .convection_W_m2_K = 0.0, .capacity_J_m2_K = 5000.0}}) {
    SupplyDesign design{.array = twelve_cells(heat), .cell_area_m2 = std::vector(12, 0.01)};
    design.max_photocurrent_A = 10.0;
    PowerSupply supply(design, 0.0);
    for (int k = 0; k < 3000; ++k) {
      supply.step(2.0 * k, 2.0, {std::vector(12, 0.55 * 1000.0 * 0.01), 120.0});
    }
    const ArrayResult steady = evaluate_array(design.array, even_light(1000.0), responsivity_A_W);
    EXPECT_NEAR(supply.temperature_K(), steady.temperature_K.value, 2e-3);
    EXPECT_NEAR(supply.state().array_W, steady.power_W.value, 1e-4 * steady.power_W.value);
    EXPECT_LE(supply.closure().largest(), 1e-12);
  }
}

TEST(CellHeat, WordsDetermineTheSurroundings) {
  EXPECT_EQ(CellHeat{}.in_words(), "both faces in still air of 293.15 K, emissivity 0.84");
  const CellHeat space{.surroundings_K = 2.725, .convection_W_m2_K = 0.0, .faces = 1};
  EXPECT_EQ(space.in_words(), "the front in a vacuum, emissivity 0.84 to 2.73 K");
}

}  // namespace
}  // namespace photorque
