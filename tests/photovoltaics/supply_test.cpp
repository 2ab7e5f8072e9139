// The power system step by step: against closed forms for constant light and load.
#include "photovoltaics/array/supply.h"

#include <gtest/gtest.h>

#include <cmath>

#include "photovoltaics/array/losses.h"
#include "reference.h"

namespace photorque {
namespace {

constexpr double cell_A = 2.0;

SupplyDesign four_cells() {
  SupplyDesign design;
  design.array = reference::array_in_series(4, 1, 4, 0);
  design.cell_area_m2.assign(4, 0.005);
  design.max_photocurrent_A = 2.0 * cell_A;
  return design;
}

PowerSupply::Light even(double current_A) {
  return {std::vector<double>(4, current_A), 20.0};
}

double best_W(const SupplyDesign& design) {
  PowerSupply alone(design, 0.0);
  alone.step(0.0, 1.0, even(cell_A));
  return alone.state().array_W;
}

// The surplus is constant, so the instant when the battery is full is known.
TEST(PowerSupply, BatteryIsFullWhenTheSurplusHasFilledIt) {
  SupplyDesign design = four_cells();
  const double array_W = best_W(design);
  design.converter_efficiency = 0.9;
  design.battery = Battery{.capacity_J = 1000.0, .charge_efficiency = 0.8};
  design.load_W = 0.5 * array_W;
  const double surplus_W = 0.9 * array_W - design.load_W;
  PowerSupply supply(design, 400.0);
  for (int k = 0; k < 4000; ++k) supply.step(k * 1.0, 1.0, even(cell_A));
  ASSERT_EQ(supply.events().size(), 1u);
  EXPECT_EQ(supply.events()[0].name, "battery_full");
  EXPECT_NEAR(supply.events()[0].time_s, 600.0 / (0.8 * surplus_W), 1e-6);
  // From then on the array gives exactly the power of the load.
  EXPECT_NEAR(supply.state().array_W, design.load_W / 0.9, 1e-12);
  EXPECT_EQ(supply.stored_J(), 1000.0);
  EXPECT_EQ(supply.energies().unserved.value(), 0.0);
  EXPECT_LE(supply.closure().largest(), 1e-12);
}

TEST(PowerSupply, BatteryIsEmptyWhenTheDeficitHasEmptiedIt) {
  SupplyDesign design = four_cells();
  const double array_W = best_W(design);
  design.battery = Battery{.capacity_J = 1000.0, .discharge_efficiency = 0.9};
  design.load_W = array_W + 3.0;
  PowerSupply supply(design, 200.0);
  for (int k = 0; k < 500; ++k) supply.step(k * 0.7, 0.7, even(cell_A));
  ASSERT_EQ(supply.events().size(), 1u);
  EXPECT_EQ(supply.events()[0].name, "battery_empty");
  EXPECT_NEAR(supply.events()[0].time_s, 200.0 * 0.9 / 3.0, 1e-6);
  EXPECT_NEAR(supply.energies().unserved.value(), 3.0 * (350.0 - 60.0), 1e-6);
  EXPECT_EQ(supply.stored_J(), 0.0);
  EXPECT_LE(supply.closure().largest(), 1e-12);
}

// Flickering light empties the battery by less than 1 % and fills it again.
TEST(PowerSupply, ABatteryThatStaysNearlyFullHasNoFurtherEvents) {
  SupplyDesign design = four_cells();
  design.battery = Battery{.capacity_J = 1000.0, .discharge_efficiency = 1.0};
  design.load_W = 0.5 * best_W(design);
  ASSERT_LT(design.load_W, 9.0);
  PowerSupply supply(design, 1000.0);
  for (int k = 0; k < 500; ++k) supply.step(k, 1.0, even(k % 5 == 0 ? 0.0 : cell_A));
  EXPECT_TRUE(supply.events().empty());
  EXPECT_EQ(supply.stored_J(), 1000.0);
  for (int k = 0; k < 10; ++k) supply.step(600.0 + 2.0 * k, 2.0, even(0.0));
  ASSERT_EQ(supply.events().size(), 1u);
  EXPECT_EQ(supply.events()[0].name, "battery_not_full");
  EXPECT_EQ(supply.events()[0].time_s, 600.0);
}

// One face with constant convection only: α E − P − h A (T − T_air) = 0 in the steady state, and
// heating without power follows an exponential.
TEST(PowerSupply, CellsWarmByTheirEquation) {
  SupplyDesign design = four_cells();
  design.array.heat = CellHeat{.air_K = 290.0,
                               .convection_W_m2_K = 10.0,
                               .emissivity = 0.0,
                               .absorptance = 0.9,
                               .faces = 1,
                               .start_K = 290.0};
  PowerSupply dark(design, 0.0);
  // Light that gives no current heats only.
  PowerSupply::Light light{std::vector<double>(4, 0.0), 20.0};
  for (int k = 0; k < 7; ++k) dark.step(30.0 * k, 30.0, light);
  const double end_K = 290.0 + 0.9 * 20.0 / (10.0 * 0.02);
  EXPECT_NEAR(dark.temperature_K(), end_K + (290.0 - end_K) * std::exp(-210.0 / 200.0), 1e-9);
  PowerSupply lit(design, 0.0);
  for (int k = 0; k < 400; ++k) lit.step(10.0 * k, 10.0, even(cell_A));
  const double balance_W =
      0.9 * 20.0 - lit.state().array_W - 10.0 * 0.02 * (lit.temperature_K() - 290.0);
  EXPECT_NEAR(balance_W, 0.0, 1e-4);
  EXPECT_LE(lit.closure().largest(), 1e-12);
}

// Curves between two known temperatures against the curve at that temperature.
TEST(PowerSupply, InterpolatesTheTemperature) {
  SupplyDesign design = four_cells();
  design.array.heat = CellHeat{.start_K = 312.3};
  PowerSupply supply(design, 0.0);
  supply.step(0.0, 1.0, even(cell_A));
  SupplyDesign warm = four_cells();
  const double factor = photocurrent_factor(warm.array.cell, 312.3) /
                        photocurrent_factor(warm.array.cell, warm.array.temperature_K);
  warm.array.temperature_K = 312.3;
  PowerSupply exact(warm, 0.0);
  exact.step(0.0, 1.0, even(cell_A * factor));
  EXPECT_NEAR(supply.state().array_W / exact.state().array_W, 1.0, 1e-4);
}

TEST(PowerSupply, ATrackerStaysBelowTheBestPoint) {
  SupplyDesign design = four_cells();
  Tracker tracker;
  tracker.kind = Tracker::Kind::perturb_and_observe;
  design.tracker = tracker;
  PowerSupply supply(design, 0.0);
  for (int k = 0; k < 2000; ++k) supply.step(0.1 * k, 0.1, even(cell_A));
  const SupplyEnergies& e = supply.energies();
  EXPECT_LE(e.array.value(), e.best.value() * (1 + 1e-12));
  EXPECT_GT(e.array.value(), 0.97 * e.best.value());
}

// Fades while on, recovers while off; equals LampDroop where it is never switched.
TEST(LampOutput, FollowsItsLags) {
  LampDroop droop;
  droop.depth = 0.2;
  droop.time_constant_s = 100.0;
  droop.roll_off_1_K = 0.005;
  droop.rise_K = 30.0;
  droop.rise_time_constant_s = 50.0;
  const LampOutput steady(droop, {}, 0.0);
  for (const double t : {0.0, 10.0, 500.0}) EXPECT_NEAR(steady.at(t), droop.light_at(t), 1e-15);
  const LampOutput switched(droop, {true, {200.0, 300.0}}, 0.0);
  EXPECT_NEAR(switched.at(199.0), droop.light_at(199.0), 1e-15);
  EXPECT_EQ(switched.at(200.0), 0.0);
  EXPECT_EQ(switched.at(299.0), 0.0);
  const double faded = (1 - std::exp(-2.0)) * std::exp(-1.0);
  const double warm = (1 - std::exp(-4.0)) * std::exp(-2.0);
  EXPECT_NEAR(switched.at(300.0), (1 - 0.2 * faded) * (1 - 0.15 * warm), 1e-15);
}

}  // namespace
}  // namespace photorque
