// From a grid of light to the headline figures of an array.
#include "photovoltaics/array/array.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/numerics/random.h"
#include "reference.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

SettingsNode::Table ten_by_ten() {
  return {{"cells", test::numbers_node({10, 10})}};
}

ArrayDesign design(SettingsNode::Table table = ten_by_ten()) {
  return reference::design(std::move(table));
}

constexpr double half_A_W = 0.5;

ArrayResult evaluate(const ArrayDesign& array, const ArrayLight& light) {
  return evaluate_array(array, light, std::array{half_A_W});
}

TEST(PhotovoltaicArray, EvenLightGivesTheSumOfItsCells) {
  const ArrayResult result =
      evaluate(design(), array_light(20, 20, 0.2, 0.2, std::vector<double>(400, 800.0)));
  EXPECT_NEAR(result.area_of_cells_m2, 0.04, 1e-15);
  EXPECT_NEAR(result.power_on_cells_W.value, 32.0, 1e-12);
  EXPECT_NEAR(result.power_W.value, result.sum_of_cells_W.value, 1e-11 * result.power_W.value);
  EXPECT_NEAR(result.mismatch_loss.value, 0.0, 1e-11);
  EXPECT_EQ(result.maxima.size(), 1u);
  EXPECT_GT(result.efficiency.value, 0.2);
  EXPECT_LT(result.efficiency.value, 0.5);
}

SettingsNode tables(std::initializer_list<SettingsNode::Table> all) {
  return {SettingsNode::Array(all.begin(), all.end())};
}

// Two cells in series without diodes: at one current their voltages add up. The numbers that are
// stated for the second belong to its area, 0.01 m², those that are not to any.
TEST(PhotovoltaicArray, ACellThatDiffersHasItsOwnCircuit) {
  SettingsNode::Table table = ten_by_ten();
  table["cells"] = test::numbers_node({2, 1});
  table["bypass"] = {"none"};
  table["cell_override"] = tables({{{"index", {1}},
                                    {"photocurrent_factor", {0.5}},
                                    {"shunt_ohm", {50.0}},
                                    {"series_ohm", {0.02}},
                                    {"reference_area_m2", {0.01}}}});
  const ArrayDesign array = design(table);
  const ArrayResult result =
      evaluate(array, array_light(20, 20, 0.2, 0.1, std::vector<double>(400, 800.0)));
  ASSERT_NEAR(result.cell_area_m2[1], 0.01, 1e-15);
  const double light_A = half_A_W * 800.0 * 0.01;
  EXPECT_NEAR(result.cell_photocurrent_A[0], light_A, 1e-12);
  EXPECT_NEAR(result.cell_photocurrent_A[1], 0.5 * light_A, 1e-12);
  const CellParameters others = parameters_at(array.cell, 0.01, array.temperature_K);
  CellParameters weak = others;
  weak.shunt_ohm = 50.0;
  weak.series_ohm = 0.02;
  const CellCurve strong_curve(others), weak_curve(weak);
  size_t points = 0;
  for (const ArrayPoint& p : result.curve) {
    const double volts = strong_curve.voltage_V(light_A, p.current_A) +
                         weak_curve.voltage_V(0.5 * light_A, p.current_A);
    EXPECT_NEAR(volts, p.voltage_V, 1e-8 * std::max(1.0, std::abs(volts)));
    ++points;
  }
  EXPECT_GT(points, 20u);
}

TEST(PhotovoltaicArray, ACellWithoutPhotocurrentIsACellInTheDark) {
  std::vector<double> irradiance(100, 1000.0);
  SettingsNode::Table table = ten_by_ten();
  table["bypass_every"] = {20};
  SettingsNode::Table dead = table;
  dead["cell_override"] = tables({{{"index", {81}}, {"photocurrent_factor", {1.0}}},
                                  {{"index", {37}}, {"photocurrent_factor", {0.0}}}});
  const double dead_W =
      evaluate(design(dead), array_light(10, 10, 0.2, 0.2, irradiance)).power_W.value;
  irradiance[37] = 0.0;
  const double dark_W =
      evaluate(design(table), array_light(10, 10, 0.2, 0.2, irradiance)).power_W.value;
  EXPECT_NEAR(dead_W, dark_W, 1e-11 * dark_W);
}

// 1 + s (T - 298.15 K) of each cell's own slope s.
TEST(PhotovoltaicArray, EachCellWarmsByItsOwnSlope) {
  SettingsNode::Table table = ten_by_ten();
  table["cell_override"] = tables({{{"index", {2}}, {"photocurrent_slope_per_K", {0.0}}}});
  ArrayDesign array = design(table);
  array.cell.photocurrent_slope_1_K = 5e-4;
  const double reference_K = array.cell.reference.temperature_K;
  const std::vector<double> warm_A =
      warmed(array, std::vector(100, 2.0), reference_K + 10.0, reference_K + 60.0);
  EXPECT_NEAR(warm_A[1], 2.0 * 1.03 / 1.005, 1e-12);
  EXPECT_EQ(warm_A[2], 2.0);
}

TEST(PhotovoltaicArray, OverridesThatMeanNothingAreRefused) {
  const auto refused = [](std::initializer_list<SettingsNode::Table> overrides) {
    SettingsNode::Table table = ten_by_ten();
    table["cell_override"] = tables(overrides);
    EXPECT_THROW(design(table), InputError);
  };
  refused({{{"index", {7}}}, {{"index", {7}}}});
  refused({{{"index", {100}}}});
  // The area is missing.
  refused({{{"index", {7}}, {"shunt_ohm", {10.0}}}});
}

TEST(PhotovoltaicArray, GapsAndMarginsLeaveTheirLightAside) {
  auto table = ten_by_ten();
  table["gap_mm"] = {2.0};
  table["margin_mm"] = {6.0};
  const ArrayResult result =
      evaluate(design(table), array_light(7, 13, 0.2, 0.2, std::vector<double>(91, 500.0)));
  const double side_m = (0.2 - 9 * 0.002 - 2 * 0.006) / 10.0;
  EXPECT_NEAR(result.area_of_cells_m2, 100 * side_m * side_m, 1e-15);
  EXPECT_NEAR(result.power_on_cells_W.value, 500.0 * 100 * side_m * side_m, 1e-12);
}

TEST(PhotovoltaicArray, PhotocurrentIsResponsivityTimesLightPerBand) {
  ArrayLight light = array_light(10, 10, 0.1, 0.1, std::vector<double>(100, 1000.0));
  ArrayLight two_bands = light;
  two_bands.bands = 2;
  two_bands.power_W = {200, 1, {}};
  for (int i = 0; i < 100; ++i) {
    two_bands.power_W.sums.push_back(0.03);
    two_bands.power_W.sums.push_back(0.07);
  }
  const ArrayResult result = evaluate_array(design(), two_bands, std::array{0.6, 0.2});
  for (const double current : result.cell_photocurrent_A) {
    EXPECT_NEAR(current, 0.6 * 0.03 + 0.2 * 0.07, 1e-15);
  }
}

// Light to watts with one cell in full shade that cannot break down: its substring of 20 is lost,
// and its bypass diode takes drop times current from the other 80 cells.
TEST(PhotovoltaicArray, DarkCellWithoutBreakdownCostsItsSubstring) {
  std::vector<double> irradiance(100, 1000.0);
  irradiance[37] = 0.0;
  auto table = ten_by_ten();
  table["bypass_every"] = {20};
  table["cell_parameters"] = {SettingsNode::Table{
      {"breakdown_fraction", {0.0}}, {"shunt_ohm", {1e9}}, {"reference_area_m2", {1e-4}}}};
  const ArrayDesign array = design(table);
  const ArrayResult result = evaluate(array, array_light(10, 10, 0.2, 0.2, irradiance));
  const CellCurve cell(parameters_at(array.cell, 4e-4, array.temperature_K));
  const double light_A = half_A_W * 1000.0 * 4e-4;
  // Largest of I (80 V_cell(I) − 0.5), by a fine grid and its parabola.
  const auto power_W = [&](double i) { return i * (80.0 * cell.voltage_V(light_A, i) - 0.5); };
  const double step_A = 1e-5 * light_A;
  double best_A = 0.9 * light_A;
  while (power_W(best_A + step_A) > power_W(best_A)) best_A += step_A;
  const double slope = 0.5 * (power_W(best_A + step_A) - power_W(best_A - step_A));
  const double bend = power_W(best_A + step_A) + power_W(best_A - step_A) - 2.0 * power_W(best_A);
  const double expected_W = power_W(best_A) - 0.5 * slope * slope / bend;
  EXPECT_NEAR(result.power_W.value, expected_W, 1e-9 * expected_W);
  double lost_V = 0.0;
  for (size_t i = 0; i < 100; ++i) lost_V += result.cells.voltages_V[i];
  EXPECT_NEAR(lost_V, result.voltage_V.value, 1e-9 * result.voltage_V.value);
  EXPECT_LT(result.cells.voltages_V[37], -5.0);
  EXPECT_LT(std::abs(result.cells.currents_A[37]), 1e-7);
}

// The spread of results over many independent data sets equals the standard error.
TEST(PhotovoltaicArray, StandardErrorIsTheSpreadOverIndependentRuns) {
  constexpr int runs = 50, replicates = 8;
  const ArrayDesign array = design();
  double sum = 0.0, squares = 0.0, predicted_gain = 0.0;
  for (uint64_t run = 0; run < runs; ++run) {
    ArrayLight light = array_light(10, 10, 0.2, 0.2, std::vector<double>(100, 500.0));
    light.power_W = {100, replicates, {}};
    for (uint64_t r = 0; r < replicates; ++r) {
      for (uint64_t b = 0; b < 100; ++b) {
        // Uniform noise with a standard deviation of 0.6 % in each bin of each replicate: small
        // against the 3 % of current over which a cell in series goes from forward to reverse.
        const double u = unit_interval(hash_words(7, run, r, b));
        light.power_W.sums.push_back(500.0 * 4e-4 * (1.0 + 0.02 * (u - 0.5)));
      }
    }
    const Estimate power = evaluate(array, light).power_W;
    sum += power.value / runs;
    squares += power.value * power.value / runs;
    predicted_gain += power.standard_error * power.standard_error / runs;
  }
  const double spread2 = (squares - sum * sum) * runs / (runs - 1.0);
  // A variance from 50 runs is uncertain by 20 %.
  EXPECT_NEAR(spread2 / predicted_gain, 1.0, 0.6);
}

TEST(PhotovoltaicArray, WrongDesignsNameTheirKey) {
  const auto message = [](const char* key, const SettingsNode& value) -> std::string {
    auto table = ten_by_ten();
    table[key] = value;
    return refusal_of([&] { design(table); });
  };
  EXPECT_THAT(message("strings", {7}), testing::HasSubstr("test.toml:7: array.strings: found 7"));
  EXPECT_THAT(message("cell", {"silicon_heterojuntion"}), testing::HasSubstr("did you mean"));
  EXPECT_THAT(message("cells", {"ten"}), testing::HasSubstr("array.cells"));
  EXPECT_THAT(message("temperature_K", {-4.0}), testing::HasSubstr("array.temperature_K"));
  EXPECT_THAT(message("wiring", {3}), testing::HasSubstr("array.wiring"));
}

}  // namespace
}  // namespace photorque
