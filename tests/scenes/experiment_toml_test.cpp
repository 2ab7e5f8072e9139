// TOML into settings, and overrides from the command line.
#include "scenes/experiment/toml.h"
#include "tests/refusal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace photorque {
namespace {

Settings settings_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  SettingsNode root = parse_toml(text, "test.toml");
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  return Settings(std::move(root));
}

std::string error_of(const std::string& text, const std::string& assignment) {
  return refusal_of([&] { settings_of(text, {assignment}); });
}

TEST(Toml, EveryTypeArrives) {
  const Settings s = settings_of(
      "flag = true\nwhole = -3\nreal = 2.5\ntext = \"a\"\nlist = [1, 2.5]\n"
      "inline = { x = 1 }\ndate = 2026-01-02\n[table]\nx = 2\n[[item]]\nx = 3\n[[item]]\nx = 4\n");
  EXPECT_TRUE(s.flag_or("flag", false));
  EXPECT_EQ(s.integer("whole", -10, 10), -3);
  EXPECT_EQ(s.number("real"), 2.5);
  EXPECT_EQ(s.text("text"), "a");
  EXPECT_EQ(s.numbers("list"), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(s.table("inline").number("x"), 1.0);
  EXPECT_EQ(s.text("date"), "2026-01-02");
  EXPECT_EQ(s.table("table").number("x"), 2.0);
  ASSERT_EQ(s.tables("item").size(), 2u);
  EXPECT_EQ(s.tables("item")[0].number("x"), 3.0);
  EXPECT_EQ(s.tables("item")[1].number("x"), 4.0);
  EXPECT_NO_THROW(s.finish());
}

TEST(Toml, EveryValueHasItsLine) {
  const Settings s = settings_of("# comment\n\n[a]\nx = 1\n[[b]]\n\ny = [1,\n 2]\n");
  EXPECT_EQ(s.table("a").where().line, 3);
  EXPECT_EQ(s.table("a").raw("x").where.line, 4);
  EXPECT_EQ(s.tables("b")[0].where().line, 5);
  EXPECT_EQ(s.tables("b")[0].raw("y").where.line, 7);
  EXPECT_EQ(s.table("a").where().file, "test.toml");
}

TEST(Toml, ACountMayBeWrittenAsARealNumber) {
  EXPECT_EQ(settings_of("rays = 1e8").integer("rays", 1, 1000000000), 100000000);
  EXPECT_THROW(settings_of("rays = 1.5").integer("rays", 1, 10), InputError);
}

TEST(Override, ReplacesTheValueAtAPath) {
  const std::string text = "[[source]]\npower_W = 1\n[[source]]\npower_W = 2\n[a.b]\nc = 3\n";
  const Settings s = settings_of(text, {"source[1].power_W=10", "a.b.c=[1, 2]", "a.d.e=true"});
  EXPECT_EQ(s.tables("source")[0].number("power_W"), 1.0);
  EXPECT_EQ(s.tables("source")[1].number("power_W"), 10.0);
  EXPECT_EQ(s.table("a").table("b").numbers("c"), (std::vector<double>{1.0, 2.0}));
  EXPECT_TRUE(s.table("a").table("d").flag_or("e", false));
}

TEST(Override, OfAnotherUnitReplacesTheSameQuantity) {
  const Settings s = settings_of("[a]\nlength_m = 2\n", {"a.length_mm=5"});
  EXPECT_DOUBLE_EQ(s.table("a").number("length_m"), 5e-3);
}

TEST(Override, TakesBareWordsAsText) {
  const Settings s =
      settings_of("", {"kind=led", "path=./a-b/c.gltf", "quoted=\"two words\"", "x=1e3"});
  EXPECT_EQ(s.text("kind"), "led");
  EXPECT_EQ(s.text("path"), "./a-b/c.gltf");
  EXPECT_EQ(s.text("quoted"), "two words");
  EXPECT_EQ(s.number("x"), 1000.0);
}

TEST(Override, OfASingleTableTakesIndexZero) {
  EXPECT_EQ(settings_of("[source]\nx = 1\n", {"source[0].x=2"}).tables("source")[0].number("x"), 2);
}

TEST(Override, IsNamedInLaterMessages) {
  const Settings s = settings_of("[a]\nx = 1\n", {"a.x=-2"});
  EXPECT_EQ(refusal_of([&] { s.table("a").number("x", Range::positive()); }),
            "--set: a.x: found -2, expected a number > 0");
}

TEST(Override, OfAnUnknownKeyIsFoundWhenSettingsFinish) {
  const Settings s = settings_of("[a]\nlength_m = 1\n", {"a.lenght_m=2"});
  EXPECT_EQ(s.table("a").number("length_m"), 1.0);
  EXPECT_EQ(refusal_of([&] { s.finish(); }),
            "--set: a.lenght_m: found an unknown key, expected a known key, perhaps "
            "\"length_m\"");
}

TEST(Override, ThatMakesNoSenseIsRefused) {
  const std::string text = "x = 1\nlist = [1, 2]\n[[t]]\ny = 1\n";
  for (const char* assignment :
       {"x", "=1", ".x=1", "x.=1", "t[=1", "t[0=1", "t[-1].y=1", "t[a].y=1", "a..b=1", "[0]=1"}) {
    EXPECT_THAT(error_of(text, assignment), testing::HasSubstr("expected KEY=VALUE"))
        << assignment << ": " << error_of(text, assignment);
  }
  EXPECT_EQ(error_of(text, "t[1].y=2"),
            "--set: t[1].y: found index 1, expected index 0, the only one");
  EXPECT_EQ(error_of(text, "x.y=2"),
            "--set: x.y: found y in 1, expected a table, or the index of one, as in source[0]");
  EXPECT_EQ(error_of(text, "x[0]=2"), "--set: x[0]: found index 0, expected no index: this is 1");
  for (const char* assignment : {"x=", "x=two words", "x=[1", "x=1\ny=2", "x={", "x=\"a"}) {
    EXPECT_NE(error_of(text, assignment), "") << assignment;
  }
}

// They once ended the program: tables within tables are walked by recursion.
TEST(Toml, KeysOfThirtyThousandPartsAreRefused) {
  std::string deep = "a";
  for (int i = 1; i < 30000; ++i) deep += ".a";
  const std::string too_deep = "a key of more than 16 parts";
  EXPECT_THAT(refusal_of([&] { parse_toml("x = 1\n[" + deep + "]\n", "e.toml"); }),
              testing::StartsWith("e.toml:2: found " + too_deep));
  EXPECT_THAT(refusal_of([&] { parse_toml(deep + " = 1\n", "e.toml"); }),
              testing::HasSubstr(too_deep));
  EXPECT_THAT(refusal_of([&] { parse_toml("t = { " + deep + " = 1 }\n", "e.toml"); }),
              testing::HasSubstr(too_deep));
  SettingsNode root;
  root.value = SettingsNode::Table{};
  EXPECT_THAT(refusal_of([&] { apply_override(root, deep + "=1"); }), testing::HasSubstr(too_deep));
  EXPECT_THAT(refusal_of([&] { apply_override(root, "a={" + deep + "=1}"); }),
              testing::HasSubstr(too_deep));
}

TEST(Toml, DotsInTextsAndCommentsAreNoKeys) {
  std::string dots(200, '.');
  EXPECT_NO_THROW(parse_toml("a = \"" + dots + "\\\"" + dots + "\" # " + dots + "\nb = \'" + dots +
                                 "\'\nc = \"\"\"" + dots + "\n" + dots + "\"\"\"\nd.\"" + dots +
                                 "\".e = [1.0, 2.0, 3.0]\n",
                             "e.toml"));
}

}  // namespace
}  // namespace photorque
