// { value, sigma } of lamps, array and attitude: a run reads the values.
#include "scenes/experiment/uncertain.h"

#include <gmock/gmock.h>

#include "core/errors.h"
#include "scenes/experiment/toml.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

TEST(Uncertain, ValuesTakeThePlaceOfThePairs) {
  SettingsNode root = parse_toml(R"(
[[source]]
power_W = 3
[[source]]
power_W = { value = 4, sigma = 0.2 }
position_m = { value = [0, 0, 1], sigma = [0, 0, 0.01] }
[array]
series_ohm = { value = 0.5, sigma = 0.1 }
cell_override = [{ index = 2, shunt_ohm = { value = 9.0, sigma = 2 } }]
[attitude]
tilt_deg = { value = 12, sigma = 0.5 }
[[disturbance]]
coefficient = { value = 1, sigma = 2 }
)",
                                 "lamps.toml");
  const std::vector<UncertainKey> found = take_uncertainty(root);
  const std::vector<UncertainKey> expected = {
      {"array.cell_override[0].shunt_ohm", {9.0}, {2.0}, false},
      {"array.series_ohm", {0.5}, {0.1}, false},
      {"attitude.tilt_deg", {12.0}, {0.5}, false},
      {"source[1].position_m", {0.0, 0.0, 1.0}, {0.0, 0.0, 0.01}, true},
      {"source[1].power_W", {4.0}, {0.2}, false}};
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].path, expected[i].path);
    EXPECT_EQ(found[i].value, expected[i].value);
    EXPECT_EQ(found[i].sigma, expected[i].sigma);
    EXPECT_EQ(found[i].is_array, expected[i].is_array);
    // Where the value stands now.
    const SettingsNode* now = find_setting(root, found[i].path);
    ASSERT_NE(now, nullptr);
    EXPECT_FALSE(now->is_table());
  }
  EXPECT_EQ(std::get<int64_t>(find_setting(root, "source[1].power_W")->value), 4);
  // Those of the motion are read by the motion.
  EXPECT_TRUE(find_setting(root, "disturbance[0].coefficient")->is_table());
}

// A misspelt half of a pair is reported.
TEST(Uncertain, PairsWithAMisspeltOrMissingKeyAreNamed) {
  const auto message = [](const char* power) {
    SettingsNode root = parse_toml(std::string("[[source]]\npower_W = ") + power, "lamps.toml");
    return refusal_of([&] { take_uncertainty(root); });
  };
  EXPECT_THAT(message("{ value = 4, sigm = 0.2 }"),
              testing::HasSubstr("lamps.toml:2: source[0].power_W.sigm: found an unknown key"));
  EXPECT_THAT(message("{ val = 4, sigma = 0.2 }"),
              testing::HasSubstr("source[0].power_W.val: found an unknown key"));
  EXPECT_THAT(message("{ value = 4, sigma = 0.2, unit = 1 }"),
              testing::HasSubstr("expected nothing beside value and sigma"));
  EXPECT_THAT(message("{ value = 4 }"), testing::HasSubstr("source[0].power_W: found no sigma"));
  EXPECT_THAT(message("{ sigma = 4 }"), testing::HasSubstr("source[0].power_W: found no value"));
}

TEST(Uncertain, ErrorsThatFitNoValueAreRefused) {
  const auto refused = [](const char* power) {
    SettingsNode root = parse_toml(std::string("[[source]]\npower_W = ") + power, "lamps.toml");
    EXPECT_THROW(take_uncertainty(root), InputError) << power;
  };
  refused("{ value = 4, sigma = -0.2 }");
  refused("{ value = 4, sigma = [1, 2] }");
  refused("{ value = [0, 0, 1], sigma = 0.1 }");
  refused("{ value = 4, sigma = \"little\" }");
  refused("{ value = \"much\", sigma = 1 }");
  refused("{ value = [], sigma = [] }");
}

}  // namespace
}  // namespace photorque
