// Mistakes of keys beside a choice.
#include <gmock/gmock.h>

#include "core/settings/typed_keys.h"

namespace photorque {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A lamp is round with a radius or square with a side; both have a power.
std::vector<Key> lamp_keys() {
  return {NumberKey("power_W", Range::positive(), "of all of it"),
          Key::choice("kind",
                      {{"round", "a disc", {NumberKey("radius_m", Range::positive(), "its")}},
                       {"square", "a tile", {NumberKey("side_m", Range::positive(), "its")}}},
                      "what it is")};
}

std::vector<std::string> mistakes(SettingsNode::Table table) {
  std::vector<std::string> lines;
  for (const InputError& error : misread_keys({std::move(table)}, lamp_keys(), "lamp")) {
    lines.emplace_back(error.what());
  }
  return lines;
}

TEST(MisreadKeys, AWrongChoiceHidesNoMisspeltKey) {
  EXPECT_THAT(mistakes({{"kind", {std::string("rund")}}, {"powr_W", {1.0}}, {"side_m", {0.1}}}),
              ElementsAre(HasSubstr("lamp.kind: found \"rund\""),
                          HasSubstr("lamp.powr_W: found an unknown key, expected a known key, "
                                    "perhaps \"power_W\"")));
}

TEST(MisreadKeys, AWrongChoiceHidesNoWrongValue) {
  EXPECT_THAT(mistakes({{"kind", {std::string("rund")}}, {"radius_m", {-0.1}}}),
              ElementsAre(HasSubstr("lamp.kind: found \"rund\""),
                          HasSubstr("lamp.radius_m: found -0.1, expected a number > 0")));
  EXPECT_THAT(mistakes({{"kind", {std::string("rund")}}, {"side_m", {0.1}}}),
              ElementsAre(HasSubstr("lamp.kind")));
}

TEST(MisreadKeys, WithoutItsChoiceAKeyOfAnyChoiceMayStand) {
  EXPECT_THAT(mistakes({{"radius_m", {0.1}}, {"power_W", {1.0}}}), ElementsAre());
  EXPECT_THAT(mistakes({{"radus_m", {0.1}}}), ElementsAre(HasSubstr("perhaps \"radius_m\"")));
}

TEST(MisreadKeys, OfAChoiceOnlyItsOwnKeysAreKnown) {
  EXPECT_THAT(mistakes({{"kind", {std::string("round")}}, {"side_m", {0.1}}}),
              ElementsAre(HasSubstr("lamp.side_m: found an unknown key")));
}

TEST(MisreadKeys, AnElementThatIsNoNumberIsNamed) {
  const auto mistake = [](SettingsNode::Array value) {
    const std::vector<Key> keys = {Vec3Key("aim_m", "its point")};
    const std::vector<InputError> errors =
        misread_keys({SettingsNode::Table{{"aim_m", {std::move(value)}}}}, keys, "lamp");
    return errors.empty() ? std::string() : std::string(errors.front().what());
  };
  EXPECT_EQ(mistake({{0.0}, {0.0}, {1.0}}), "");
  EXPECT_THAT(mistake({{0.0}, {std::string("x")}, {1.0}}),
              HasSubstr("lamp.aim_m[1]: found \"x\", expected a number"));
  EXPECT_THAT(mistake({{0.0}, {std::string("x")}}),
              HasSubstr("lamp.aim_m: found an array of 2, expected an array of 3 numbers"));
}

}  // namespace
}  // namespace photorque
