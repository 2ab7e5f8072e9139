#include "core/settings/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/constants.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

SettingsNode leaf(
    std::variant<bool, int64_t, double, std::string, SettingsNode::Array, SettingsNode::Table>
        value,
    int line) {
  return {std::move(value), {"lab.toml", line}};
}

Settings lab(SettingsNode::Table table) {
  return Settings(SettingsNode{std::move(table), {"lab.toml", 1}});
}

TEST(Units, EveryKeyOfAQuantityGivesSI) {
  EXPECT_DOUBLE_EQ(lab({{"fwhm_deg", leaf(180.0, 2)}}).number("fwhm_deg"), pi);
  EXPECT_DOUBLE_EQ(lab({{"fwhm_mrad", leaf(5.0, 2)}}).number("fwhm_deg"), 5e-3);
  EXPECT_DOUBLE_EQ(lab({{"pitch_mm", leaf(int64_t{46}, 2)}}).number("pitch_m"), 0.046);
  EXPECT_DOUBLE_EQ(lab({{"rate_rpm", leaf(60.0, 2)}}).number("rate_rad_s"), 2 * pi);
  EXPECT_DOUBLE_EQ(lab({{"capacity_mAh", leaf(1000.0, 2)}}).number("capacity_Ah"), 3600.0);
}

TEST(Units, LongestSuffixWins) {
  EXPECT_EQ(unit_of_key("torque_N_m").unit, "N_m");
  EXPECT_EQ(unit_of_key("momentum_N_m_s").unit, "N_m_s");
  EXPECT_EQ(unit_of_key("shift_m_per_Ah").stem, "shift");
  // 1 N m per degree is 57.3 N m per radian.
  EXPECT_NEAR(unit_of_key("stiffness_N_m_per_deg").to_SI, 180.0 / pi, 1e-12);
  EXPECT_EQ(unit_of_key("stiffness_N_m_per_deg").stem, unit_of_key("stiffness_N_m_per_rad").stem);
  EXPECT_EQ(unit_of_key("offset_m").unit, "m");
  // 1 mm² = (1e-3 m)².
  EXPECT_DOUBLE_EQ(unit_of_key("hole_area_mm2").to_SI, 1e-6);
  EXPECT_EQ(unit_of_key("hole_area_mm2").stem, unit_of_key("hole_area_m2").stem);
  EXPECT_EQ(unit_of_key("kind").unit, "");
}

TEST(Units, MissingAndDoubledAreRefused) {
  const Settings bare = lab({{"fwhm", leaf(3.0, 7)}});
  EXPECT_THAT(refusal_of([&] { bare.number("fwhm_deg"); }), testing::HasSubstr("lab.toml:7: fwhm"));
  const Settings twice = lab({{"pitch_mm", leaf(1.0, 2)}, {"pitch_m", leaf(1.0, 3)}});
  EXPECT_THAT(refusal_of([&] { twice.number("pitch_m"); }),
              testing::HasSubstr("the same quantity"));
}

TEST(Keys, UnreadKeyIsAnErrorWithTheNearestName) {
  const Settings settings = lab({{"power_W", leaf(1.0, 2)}, {"apperture_m", leaf(0.1, 5)}});
  settings.number("power_W");
  settings.number_or("aperture_m", 0.0);
  EXPECT_EQ(refusal_of([&] { settings.finish(); }),
            "lab.toml:5: apperture_m: found an unknown key, expected a known key, perhaps "
            "\"aperture_m\"");
}

TEST(Keys, UnreadKeyWithoutUnitIsTheOneWithAUnit) {
  const Settings settings = lab({{"tilt", leaf(3.0, 4)}});
  for (const char* key : {"heading_deg", "tilt_deg"}) settings.number_or(key, 0.0);
  EXPECT_THAT(refusal_of([&] { settings.finish(); }), testing::HasSubstr("perhaps \"tilt_deg\""));
}

TEST(Keys, UnreadKeyLikeNoneListsThoseThatAreKnown) {
  const Settings settings = lab({{"wavelength_nm", leaf(730.0, 4)}});
  for (const char* key : {"power_W", "exponent"}) settings.number_or(key, 0.0);
  EXPECT_EQ(refusal_of([&] { settings.finish(); }),
            "lab.toml:4: wavelength_nm: found an unknown key, expected one of \"exponent\", "
            "\"power_W\"");
}

TEST(Keys, MissingKeyPointsToItsMisspelling) {
  const Settings settings = lab({{"power_W", leaf(1.0, 2)}, {"apperture_m", leaf(0.1, 5)}});
  settings.number("power_W");
  EXPECT_THAT(
      refusal_of([&] { settings.number("aperture_m"); }),
      testing::HasSubstr(
          "found nothing, expected a finite number m (is \"apperture_m\" in line 5 meant?)"));
  EXPECT_THAT(refusal_of([&] { settings.number("exponent"); }),
              testing::EndsWith("a finite number"));
}

TEST(Keys, UnreadKeyOfASubTableIsFound) {
  const Settings settings =
      lab({{"scene", leaf(SettingsNode::Table{{"fiel", leaf(std::string("x"), 9)}}, 8)}});
  settings.table("scene").text_or("file", "");
  EXPECT_THAT(refusal_of([&] { settings.finish(); }),
              testing::StartsWith("lab.toml:9: scene.fiel"));
}

TEST(Ranges, AreCheckedInTheUsersUnit) {
  const Settings settings = lab({{"tilt_deg", leaf(200.0, 4)}});
  EXPECT_EQ(refusal_of([&] {
              settings.number("tilt_deg", {0.0, pi});
            }),
            "lab.toml:4: tilt_deg: found 200, expected a number in [0, 180] deg");
  EXPECT_THAT(refusal_of([&] {
                lab({{"power_W", leaf(std::nan(""), 1)}}).number("power_W");
              }),
              testing::HasSubstr("finite"));
}

TEST(Values, UncertainNumbersCarryTheirSigma) {
  const Settings settings =
      lab({{"offset_mm",
            leaf(SettingsNode::Table{{"value", leaf(2.0, 3)}, {"sigma", leaf(0.5, 3)}}, 3)}});
  const Uncertain offset = settings.uncertain("offset_m");
  EXPECT_DOUBLE_EQ(offset.value, 2e-3);
  EXPECT_DOUBLE_EQ(offset.sigma, 5e-4);
  settings.finish();
}

TEST(Values, WrongTypesStateTheValueFound) {
  const Settings settings = lab({{"kind", leaf(int64_t{3}, 2)},
                                 {"n", leaf(2.5, 3)},
                                 {"v", leaf(SettingsNode::Array{leaf(1.0, 4)}, 4)}});
  EXPECT_THAT(refusal_of([&] { settings.text("kind"); }),
              testing::HasSubstr("found 3, expected a text"));
  EXPECT_THAT(refusal_of([&] { settings.integer("n", 0, 9); }),
              testing::HasSubstr("found 2.5, expected a whole number"));
  EXPECT_THAT(refusal_of([&] { settings.vector3("v"); }), testing::HasSubstr("an array of 1"));
  // A diagonal is no matrix yet.
  const SettingsNode diagonal =
      leaf(SettingsNode::Array{leaf(1.0, 3), leaf(2.0, 3), leaf(3.0, 3)}, 3);
  EXPECT_THAT(refusal_of([&] {
                lab({{"m", diagonal}}).matrix3("m");
              }),
              testing::HasSubstr("found an array of 3, expected an array of 3 rows of 3 numbers"));
  EXPECT_THAT(refusal_of([&] {
                settings.choice("kind", {"led", "sun"});
              }),
              testing::HasSubstr("one of \"led\", \"sun\""));
}

}  // namespace
}  // namespace photorque
