// The exact powers of the reference maps and the ngspice curves.
#include "photovoltaic_reference.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace photorque {
namespace {

struct MapCase {
  const char* map;
  std::vector<std::array<double, 2>> maxima;  // power in W, voltage in V; as many digits as printed
};

void expect_maxima(const ArrayCurve& curve, const MapCase& expected, double power_digit_W,
                   double voltage_digit_V) {
  const std::vector<ArrayPoint> found = curve.maxima();
  for (const auto& [power_W, voltage_V] : expected.maxima) {
    const bool there = std::ranges::any_of(found, [&, p = power_W, v = voltage_V](ArrayPoint x) {
      return std::abs(x.power_W() - p) <= 0.51 * power_digit_W &&
             std::abs(x.voltage_V - v) <= 0.51 * voltage_digit_V;
    });
    EXPECT_TRUE(there) << expected.map << ": no maximum of " << power_W << " W at " << voltage_V
                       << " V among " << found.size();
  }
}

class ReferenceMaps : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    suns_ = reference::suns(GetParam());
    if (suns_.size() != 100) GTEST_SKIP() << "no reference maps beside this source tree";
  }
  std::vector<double> suns_;
};

// electrical.md, section B: power to 1e-6 W and the number of local maxima.
TEST_P(ReferenceMaps, SeriesStringWithClampsHasTheExactMaxima) {
  const std::map<std::string, std::tuple<double, double, size_t>> exact = {
      {"uniform", {334.668071, 56.5756, 1}},
      {"gauss_edge", {141.372043, 62.0713, 2}},
      {"tilt30", {124.038910, 48.7063, 2}},
      {"shadow2", {125.739474, 21.8498, 3}}};
  const auto [power_W, voltage_V, count] = exact.at(GetParam());
  const ArrayCurve curve =
      reference::curve(reference::series_5(reference::clamp()), suns_, reference::cell());
  const ArrayPoint best = curve.maximum_power();
  EXPECT_NEAR(best.power_W(), power_W, 0.51e-6);
  EXPECT_NEAR(best.voltage_V, voltage_V, 0.51e-4);
  EXPECT_EQ(curve.maxima().size(), count);
}

// electrical.md, section C: every maximum with real diodes, to the printed 1e-5 W and 1e-3 V.
TEST_P(ReferenceMaps, SeriesStringWithRealDiodesHasTheExactMaxima) {
  const std::map<std::string, std::vector<std::array<double, 2>>> exact = {
      {"uniform", {{334.66790, 56.576}}},
      {"gauss_edge", {{141.37193, 62.071}, {115.42750, 35.879}}},
      {"tilt30", {{124.42678, 48.859}, {113.91556, 54.887}}},
      {"shadow2", {{126.86103, 21.588}, {93.53993, 37.667}, {59.21543, 60.102}}}};
  const ArrayCurve curve = reference::curve(reference::series_5(reference::schottky()), suns_,
                                            reference::cell(reference::ngspice_temperature_K()));
  const MapCase expected{GetParam(), exact.at(GetParam())};
  expect_maxima(curve, expected, 1e-5, 1e-3);
  EXPECT_EQ(curve.maxima().size(), expected.maxima.size());
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Photovoltaic, ReferenceMaps,
                         testing::Values("uniform", "gauss_edge", "tilt30", "shadow2"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace photorque
