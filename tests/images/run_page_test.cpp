// Pages of runs, as far as no browser is needed: tests/page has the rest.
#include "images/browser/run_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <regex>

#include "core/errors.h"
#include "images/browser/content.h"
#include "tests/files.h"

namespace photorque {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Map map_of(int width, int height, std::vector<double> value) {
  Map map{"irradiance", "Irradiance", "W/m²", width, height};
  map.value = std::move(value);
  map.standard_error.assign(map.value.size(), 0.1);
  return map;
}

Plot plot_of(const std::string& name, std::vector<double> x, std::vector<double> y) {
  Plot plot;
  plot.name = plot.title = plot.x_label = plot.y_label = name;
  plot.curves = {{name, std::move(x), std::move(y)}};
  return plot;
}

// A triangle with one state.
SceneStage stage_of_one() {
  SceneStage stage;
  stage.parts = {{"plate", {0.5, 0.5, 0.5}, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}}};
  stage.states = {{{Quat::Identity()}, {}, {}, {}}};
  return stage;
}

TEST(RunPage, NamesNeverBecomeMarkup) {
  const std::string hostile = "</script><script>alert(1)</script><!-- \xE2\x80\xA8 & \xff";
  RunPage page;
  page.title = page.verb = page.command = page.headline = hostile;
  page.figures = {{hostile, hostile, hostile, {1.0, 0.0}}};
  page.power = {{hostile, {1.0, 0.0}, true}};
  page.notes = {hostile};
  Map map = map_of(1, 1, {1.0});
  map.name = map.title = map.unit = map.x_label = map.y_label = hostile;
  page.product.maps = {map};
  page.product.tables = {
      Table::of(hostile, hostile).add(hostile, std::vector<std::string>{hostile})};
  page.product.plots = {plot_of(hostile, {1.0}, {1.0})};
  page.provenance.inputs = {{hostile, hostile}};
  page.provenance.warnings = {hostile};
  page.stage = stage_of_one();
  page.stage->parts[0].name = page.stage->remark = hostile;
  page.stage->lamps = {{hostile}};
  const std::string html = page_html(page);
  EXPECT_EQ(occurrences(html, "<script"), 2u);
  EXPECT_EQ(occurrences(html, "</script"), 2u);
  EXPECT_EQ(occurrences(html, "<!--"), 0u);
  EXPECT_GT(occurrences(html, "\\u003c/script\\u003e"), 10u);
  const std::string content = script_text(page_content(page, {}));
  EXPECT_EQ(occurrences(content, "\xE2\x80\xA8"), 0u);  // ends a line of a script
  EXPECT_EQ(content.find_first_of("<>&"), std::string::npos);
  EXPECT_TRUE(html == page_html(page));
}

// Nothing on the page may ask for anything outside of it, and the policy would forbid it.
TEST(RunPage, NeedsNoNetwork) {
  const std::string html = page_html({});
  EXPECT_EQ(occurrences(html, "default-src 'none'"), 1u);
  EXPECT_EQ(occurrences(html, "script-src 'unsafe-inline'"), 0u);
  std::smatch nonce;
  const std::string head = html.substr(0, 1000);
  ASSERT_TRUE(std::regex_search(head, nonce, std::regex("script-src 'nonce-([0-9a-f]{32})'")));
  EXPECT_EQ(occurrences(html, "<script nonce=\"" + nonce[1].str() + "\">"), 1u);
  EXPECT_FALSE(std::regex_search(std::string(page_style()), std::regex("url\\(|@import")));
  EXPECT_EQ(occurrences(html, " src=") + occurrences(html, "<link"), 0u);
  EXPECT_GT(page_script().size(), 100'000u);
}

TEST(RunPage, ArraysKeepTheirNumbers) {
  const std::vector<float> numbers = {1.0f, -2.5f};
  // 1.0f is 0x3f800000, −2.5f 0xc0200000, lowest byte first.
  EXPECT_EQ(packed(numbers)["f32"], "AACAPwAAIMA=");
  const std::vector<double> values = {0.0, 32767.0, 65534.0, nan};
  const auto coarse = packed_coarse(values, 0.0, 65534.0);
  EXPECT_EQ(coarse["step"], 1.0);
  EXPECT_EQ(coarse["u16"], "AAD/f/7///8=");  // 0, 0x7fff, 0xfffe, 0xffff
}

TEST(RunPage, LargeMapsBecomeMeansOfBlocks) {
  const Map small = reduced(map_of(3, 2, {1, 3, 10, 5, nan, nan}), 2);
  EXPECT_EQ(small.width, 2);
  EXPECT_EQ(small.height, 1);
  EXPECT_THAT(small.value, ::testing::ElementsAre(3.0, 10.0));
  EXPECT_TRUE(small.standard_error.empty());
  const Map large = map_of(64, 64, std::vector<double>(4096, 1.0));
  const Map tiny = map_of(8, 8, std::vector<double>(64, 1.0));
  EXPECT_THAT(map_reductions({large, tiny}, 5000), ::testing::ElementsAre(1, 1));
  EXPECT_THAT(map_reductions({large, tiny}, 1100), ::testing::ElementsAre(2, 1));
  EXPECT_THAT(map_reductions({large, tiny}, 20), ::testing::ElementsAre(32, 2));
}

TEST(RunPage, LongTablesAndCurvesAreCutWithANote) {
  RunPage page;
  std::vector<double> x(1000), y(1000, 0.0);
  for (size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i);
  y[617] = 5.0;
  page.product.tables = {Table::of("long", "Long").add("x", x)};
  page.product.plots = {plot_of("plot", x, y)};
  PageLimits limits;
  limits.table_rows = 10;
  limits.curve_points = 100;
  const auto json = page_content(page, limits);
  EXPECT_EQ(json["tables"][0]["rows"], 1000);
  EXPECT_EQ(json["tables"][0]["columns"][0]["cells"].size(), 10u);
  const auto& curve = json["plots"][0]["panels"][0]["curves"][0];
  EXPECT_EQ(curve["thinned_from"], 1000);
  const std::string kept = curve["y"]["f32"];
  EXPECT_LE(kept.size(), 100u * 4u * 4u / 3u + 4u);
  // Zeros are all A: anything else is the peak.
  EXPECT_NE(kept.find_first_not_of("A="), std::string::npos);
}

TEST(RunPage, PartsWithVeryManyTrianglesAreBoxes) {
  RunPage page;
  page.stage = stage_of_one();
  StagePart& part = page.stage->parts[0];
  for (int i = 0; i < 100; ++i) part.triangles.insert(part.triangles.end(), {0, 1, 2});
  PageLimits limits;
  limits.triangles = 50;
  const auto json = page_content(page, limits);
  EXPECT_EQ(json["stage"]["parts"][0]["triangles"]["u32"].get<std::string>().size(), 192u);  // 36
  EXPECT_EQ(json["stage"]["remark"], "1 part with very many triangles is drawn as boxes.");
}

TEST(RunPage, StatesMustFitTheirStage) {
  RunPage page;
  page.stage = stage_of_one();
  page.stage->axes = {{"tilt", "deg", {0.0, 10.0}}};
  EXPECT_THROW(page_html(page), InputError);  // one state for two nodes
  page.stage->axes.clear();
  page.stage->arrows = {{"force", "N"}};
  EXPECT_THROW(page_html(page), InputError);  // a state without the arrow
  page.stage = stage_of_one();
  page.stage->paintings = {{"Irradiance", "W/m²", false, {{}}}};
  page.stage->paintings[0].surfaces[0].map = "absent";
  EXPECT_THROW(page_html(page), InputError);
}

}  // namespace
}  // namespace photorque
