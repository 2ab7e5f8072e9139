// The array's circuit of the diagnosis of light: its curve against the network of photovoltaics/,
// its derivatives against differences.
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/light/model/network.h"
#include "photovoltaics/array/design.h"
#include "photovoltaics/network/curve.h"

namespace photorque {
namespace {

constexpr int columns = 4, rows = 3;
constexpr double area_m2 = 0.0025;

CellModel a_cell() {
  CellModel cell;
  cell.reference = {1.2e-11, 1.05, 0.0, 2.0, 0.01, 150.0, 0.0, -15.0, 3.0, 298.15};
  cell.reference_area_m2 = area_m2;
  return cell;
}

struct ArrayUnderTest {
  ArrayWiring wiring;
  std::vector<double> photocurrents_A;
  double series_ohm = 0.0;

  explicit ArrayUnderTest(int strings) {
    RegularWiring options;
    options.strings = strings;
    options.bypass_every = 3;
    options.bypass.kind = Diode::Kind::clamp;
    wiring = regular_wiring(columns, rows, options);
    for (int i = 0; i < columns * rows; ++i) {
      photocurrents_A.push_back(0.8 + 0.3 * std::sin(1.7 * i));
    }
  }
  LitNetwork network(bool tabulated = false) const {
    const std::vector<double> areas(photocurrents_A.size(), area_m2);
    const CellModel cell = a_cell();
    const std::vector<const CellModel*> models(areas.size(), &cell);
    NetworkSettings settings;
    settings.series_ohm = series_ohm;
    return {wiring,
            std::make_shared<const LitCells>(lit_cells(models, areas, 298.15, 0.0, tabulated)),
            settings, photocurrents_A};
  }
  ArrayCurve curve() const {
    const auto table = std::make_shared<const DiodeVoltageTable>(
        CellCurve(parameters_at(a_cell(), area_m2, 298.15)), 5.0);
    return {wiring, CellTables(photocurrents_A.size(), table), photocurrents_A};
  }
};

class LightNetwork : public testing::TestWithParam<int> {};

TEST_P(LightNetwork, MaximaAreThoseOfTheArrayCurve) {
  const ArrayUnderTest array(GetParam());
  std::vector<ArrayPoint> expected = array.curve().maxima();
  std::sort(expected.begin(), expected.end(),
            [](const auto& a, const auto& b) { return a.power_W() > b.power_W(); });
  const auto found = array.network().maxima(LitNetwork::Which::all, false);
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GE(found.size(), 2u);
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].voltage_V, expected[i].voltage_V, 1e-7);
    EXPECT_NEAR(found[i].current_A, expected[i].current_A, 1e-7);
  }
  const auto highest = array.network().maxima(LitNetwork::Which::highest, false);
  EXPECT_NEAR(highest.front().power_W(), expected.front().power_W(), 1e-9);
}

// As a shaded cell gets more light, a maximum goes away: in a corner of the curve, which stays
// where the maximum was last, and is told as long as a little less light brings it back.
TEST_P(LightNetwork, MaximumThatVanishesLeavesACorner) {
  ArrayUnderTest array(GetParam());
  std::ranges::fill(array.photocurrents_A, 1.0);
  const auto at = [&](double light) {
    array.photocurrents_A[4] = light;
    return array.network().maxima(LitNetwork::Which::with_corners, false);
  };
  const auto count = [](const std::vector<LitNetwork::Maximum>& found) {
    return std::ranges::count_if(found, [](const auto& m) { return !m.is_corner; });
  };
  double with = 0.5, without = 1.0;
  ASSERT_EQ(count(at(with)), 2);
  ASSERT_EQ(count(at(without)), 1);
  while (without - with > 1e-7) {
    const double middle = 0.5 * (with + without);
    (count(at(middle)) == 2 ? with : without) = middle;
  }
  const auto last = at(with)[1];
  const auto after = at(without);
  ASSERT_EQ(after.size(), 2u);
  ASSERT_TRUE(after[1].is_corner);
  EXPECT_NEAR(after[1].voltage_V, last.voltage_V, 2e-3 * last.voltage_V);
  EXPECT_NEAR(after[1].current_A, last.current_A, 2e-3 * last.current_A);
  EXPECT_EQ(at(without + 0.001).size(), 2u);
  EXPECT_EQ(at(1.0).size(), 1u);
}

TEST_P(LightNetwork, MaximumMovesAsItsDerivativesSay) {
  ArrayUnderTest array(GetParam());
  array.series_ohm = 0.15;
  const auto at = array.network().maxima(LitNetwork::Which::highest, true).front();
  constexpr double step_A = 1e-5;
  for (size_t k = 0; k < array.photocurrents_A.size(); ++k) {
    const double before = array.photocurrents_A[k];
    array.photocurrents_A[k] = before + step_A;
    const auto high = array.network().maxima(LitNetwork::Which::highest, false).front();
    array.photocurrents_A[k] = before - step_A;
    const auto low = array.network().maxima(LitNetwork::Which::highest, false).front();
    array.photocurrents_A[k] = before;
    EXPECT_NEAR(at.voltage_by_photocurrent[k], (high.voltage_V - low.voltage_V) / (2 * step_A),
                1e-3);
    EXPECT_NEAR(at.current_by_photocurrent[k], (high.current_A - low.current_A) / (2 * step_A),
                1e-3);
  }
}

TEST_P(LightNetwork, NearestPointLiesOnTheCurveAndAcrossIt) {
  const ArrayUnderTest array(GetParam());
  const LitNetwork network = array.network(true);
  const ArrayCurve curve = array.curve();
  constexpr double sigma_V = 0.01, sigma_A = 0.006;
  for (double part = 0.02; part < 1.0; part += 0.07) {
    const double voltage_V = part * curve.open_circuit_V();
    const double current_A = curve.current_A(voltage_V) + 0.004;
    const auto p = network.nearest(voltage_V, current_A, sigma_V, sigma_A, true);
    EXPECT_NEAR(p.current_A, curve.current_A(p.voltage_V), 1e-6) << part;
    // At the foot the way to the reading is at right angles to the curve, in errors.
    const double along = (voltage_V - p.voltage_V) / (sigma_V * sigma_V) -
                         p.slope_S * (current_A - p.current_A) / (sigma_A * sigma_A);
    const double length = std::hypot(1.0 / sigma_V, p.slope_S / sigma_A);
    EXPECT_LT(std::abs(along) / length, 0.02) << part;
  }
}

INSTANTIATE_TEST_SUITE_P(Strings, LightNetwork, testing::Values(1, 2));

}  // namespace
}  // namespace photorque
