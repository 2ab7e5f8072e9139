// Wirings as an experiment states them: against ngspice, and against each other.
#include <map>

#include "reference.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

SettingsNode list(SettingsNode::Array members) {
  return {std::move(members)};
}

SettingsNode words(const std::vector<std::string>& texts) {
  SettingsNode::Array array;
  for (const std::string& text : texts) array.push_back({text});
  return list(std::move(array));
}

ArrayDesign design(double columns, double rows, const std::string& key, const SettingsNode& value,
                   const std::string& bypass, double temperature_K = 298.15) {
  SettingsNode::Table table = {{"cells", test::numbers_node({columns, rows})},
                               {"bypass", {bypass}},
                               {"temperature_K", {temperature_K}}};
  table[key] = value;
  return reference::design(std::move(table));
}

// The levels are those of tests/data/ngspice_wirings.py, which made the currents.
TEST(PhotovoltaicWirings, EightWiringsUnderThreeMapsAgreeWithNgspice) {
  const std::map<std::string, std::vector<std::string>> wirings = {
      {"series", {"series 100"}},
      {"half_cut", {"series 5 bypass", "parallel 2", "series 10"}},
      {"shingled", {"series 2 bypass", "parallel 5", "series 10"}},
      {"cross_tied", {"series 10", "parallel 10"}},
      {"bypass_per_cell", {"series 100 bypass"}},
      {"strings", {"parallel 5", "series 4 bypass", "series 5"}},
      {"tied_modules", {"series 5", "parallel 4 bypass", "series 5"}},
      {"nested", {"parallel 2", "series 5 bypass", "parallel 2", "series 5 bypass"}}};
  const double temperature_K = reference::ngspice_temperature_K();
  std::map<std::string, ArrayCurve> curves;
  size_t compared = 0;
  for (const auto& row : csv_rows(reference::file("ngspice_wirings"))) {
    const std::string &wiring = row.at(0), &map = row.at(1), &voltage = row.at(2);
    const std::string name = wiring + " " + map;
    if (!curves.contains(name)) {
      const ArrayDesign array =
          design(10, 10, "circuit", words(wirings.at(wiring)), "junction", temperature_K);
      curves.emplace(name, reference::curve(array.wiring, reference::suns(map),
                                            reference::cell(temperature_K)));
    }
    const double expected_A = std::stod(row.at(3));
    const double apart = std::abs(curves.at(name).current_A(std::stod(voltage)) / expected_A - 1.0);
    EXPECT_LE(apart, 1e-6) << name << " at " << voltage << " V";
    ++compared;
  }
  EXPECT_EQ(curves.size(), 24u);
  EXPECT_GE(compared, 350u);
}

// Regular keys, levels and lists give equal wirings.
TEST(PhotovoltaicWirings, LevelsAreTheRegularKeysInOtherWords) {
  std::vector<double> suns;
  for (int i = 0; i < 12; ++i) suns.push_back(0.6 + 0.35 * std::sin(2.3 * i));
  const auto maxima = [&](const ArrayDesign& array) {
    return reference::curve(array.wiring, suns, reference::cell()).maxima();
  };
  const auto strings = maxima(design(3, 4, "strings", {3}, "ideal"));
  const auto levels =
      maxima(design(3, 4, "circuit", words({"parallel 3 bypass", "series 4"}), "ideal"));
  ASSERT_EQ(strings.size(), levels.size());
  for (size_t i = 0; i < strings.size(); ++i) {
    EXPECT_NEAR(strings[i].power_W(), levels[i].power_W(), 1e-10);
  }
  const auto every = maxima(design(3, 4, "bypass_every", {1}, "ideal"));
  const auto each = maxima(design(3, 4, "circuit", words({"series 12 bypass"}), "ideal"));
  ASSERT_EQ(every.size(), each.size());
  for (size_t i = 0; i < every.size(); ++i) {
    EXPECT_NEAR(every[i].power_W(), each[i].power_W(), 1e-10);
  }
}

TEST(PhotovoltaicWirings, MistakesStateTheExpectedValue) {
  const auto message = [](const std::string& key, const SettingsNode& value) -> std::string {
    return refusal_of([&] { design(3, 4, key, value, "ideal"); });
  };
  EXPECT_THAT(message("circuit", words({"series 3", "parallel 5"})),
              testing::HasSubstr("found 15 cells"));
  EXPECT_THAT(message("circuit", words({"series x"})), testing::HasSubstr("\"series N\""));
  EXPECT_THAT(message("circuit", words({"in series 12"})), testing::HasSubstr("\"series N\""));
  EXPECT_THAT(message("circuit", words({"series 12 bypassed"})), testing::HasSubstr("\"bypass\""));
  const SettingsNode twice = list({list({list({list({{1}, list({{1}})})})})});
  EXPECT_THAT(message("wiring", twice), testing::HasSubstr("at most once"));
  SettingsNode deep = {0};
  for (int i = 0; i < 60; ++i) deep = list({deep});
  EXPECT_THAT(message("wiring", deep), testing::HasSubstr("32 levels"));
}

}  // namespace
}  // namespace photorque
