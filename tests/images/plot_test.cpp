#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <regex>

#include "core/text/format.h"
#include "images/drawing/curves.h"
#include "images/drawing/page_layout.h"
#include "images/drawing/plot.h"
#include "tests/images/sample_product.h"

namespace photorque {
namespace {

const Rgb blue = curve_stroke(0).colour;

std::vector<PagePoint> noisy_line(size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<PagePoint> line;
  for (size_t i = 0; i < count; ++i) {
    const double x = 300.0 * static_cast<double>(i) / static_cast<double>(count);
    line.push_back({x, 50.0 * std::sin(0.05 * x) + 10.0 * normal(generator)});
  }
  return line;
}

// A waterfall: a loss is drawn between the previous power and the remainder.
TEST(Plot, BarsHangBetweenTwoValuesWithTheirNamesUnderThem) {
  Plot plot{"falls", "Falls", "", "power [W]", {}, false, false, {}};
  const auto bar = [&](const std::string& name, double x, double from, double to) {
    Plot::Curve curve{name, {x, x}, {from, to}, {}, false, true};
    plot.curves.push_back(curve);
  };
  bar("emitted", 1, 0, 80);
  bar("lost on the way", 2, 80, 60);
  bar("left", 3, 0, 60);
  const std::string svg = svg_of(plot_html(plot));
  const auto height = [&](size_t bar) {
    const DrawnPath corners = paths_of(svg, "fill", curve_stroke(bar).colour).at(0);
    return std::abs(corners.at(2).second - corners.at(1).second);
  };
  EXPECT_NEAR(height(1) / height(0), 20.0 / 80.0, 0.01);
  const PlotLayout layout = plot_layout(plot, {.left = 0.0, .right = 600.0, .top = 0.0});
  EXPECT_TRUE(layout.legends.front().curves.empty());
  EXPECT_TRUE(layout.panels.front().x.ticks.values.empty());
  EXPECT_GT(layout.bottom, layout.panels.front().frame.bottom() + 15.0) << "room for names";
}

TEST(Axis, OfAngleCountsPartsOfATurn) {
  EXPECT_THAT(horizontal_axis({-180.0, 180.0}, false, "azimuth [deg]", 440.0).ticks.values,
              testing::ElementsAre(-180, -135, -90, -45, 0, 45, 90, 135, 180));
  EXPECT_THAT(vertical_axis({-90.0, 90.0}, false, "elevation [deg]", 220.0).ticks.labels,
              testing::ElementsAre("−90", "−60", "−30", "0", "30", "60", "90"));
  EXPECT_THAT(horizontal_axis({0.0, 30.0}, false, "tilt [deg]", 440.0).ticks.values,
              testing::ElementsAre(0, 5, 10, 15, 20, 25, 30));
}

TEST(Thinned, KeepsTheExtremesOfEveryColumn) {
  const std::vector<PagePoint> line = noisy_line(200000, 1);
  const std::vector<PagePoint> kept = thinned(line, 0.5);
  EXPECT_LE(kept.size(), 4u * 601u);
  std::map<int, std::pair<double, double>> expected;
  std::map<int, std::pair<double, double>> found;
  const auto include = [](auto& extremes, const PagePoint& p) {
    auto& [low, high] = extremes.try_emplace(static_cast<int>(p.x / 0.5), p.y, p.y).first->second;
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  };
  for (const PagePoint& p : line) include(expected, p);
  for (const PagePoint& p : kept) include(found, p);
  EXPECT_EQ(found, expected);
  EXPECT_TRUE(std::ranges::is_sorted(kept, {}, &PagePoint::x));
}

TEST(Thinned, LeavesShortAndTurningLinesAlone) {
  EXPECT_EQ(thinned(noisy_line(100, 2), 0.5).size(), 100u);
  std::vector<PagePoint> circle;
  for (int i = 0; i < 50000; ++i) circle.push_back({std::cos(0.01 * i), std::sin(0.01 * i)});
  EXPECT_EQ(thinned(circle, 0.5).size(), circle.size());
  EXPECT_TRUE(thinned({}, 0.5).empty());
}

ChartPanel unit_panel(std::vector<Plot::Curve> curves) {
  Axis axis;
  axis.range = {0.0, 1.0};
  return {{100.0, 50.0, 400.0, 300.0}, axis, axis, std::move(curves)};
}

// Dense samples along every segment decide independently of how free_corner clips.
bool passes_through(const ChartPanel& panel, const PageBox& box) {
  for (const Plot::Curve& curve : panel.curves) {
    for (size_t i = 1; i < curve.x.size(); ++i) {
      for (double t = 0.0; t <= 1.0; t += 1.0 / 512.0) {
        const PagePoint p = panel.at(std::lerp(curve.x[i - 1], curve.x[i], t),
                                     std::lerp(curve.y[i - 1], curve.y[i], t));
        if (p.x > box.x && p.x < box.right() && p.y > box.y && p.y < box.bottom()) return true;
      }
    }
  }
  return false;
}

TEST(FreeCorner, CoversNoCurve) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Legend legend{{0}, 120.0, 60.0};
  int found = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Plot::Curve curve{"a"};
    for (int i = 0; i < 10; ++i) {
      curve.x.push_back(uniform(generator));
      curve.y.push_back(uniform(generator));
    }
    const ChartPanel panel = unit_panel({curve});
    const std::optional<PagePoint> corner = free_corner(panel, legend);
    if (!corner) continue;
    ++found;
    EXPECT_FALSE(passes_through(panel, {corner->x, corner->y, legend.width, legend.height}));
  }
  EXPECT_GT(found, 30);
  EXPECT_LT(found, 300) << "some of these lines leave no corner";
}

TEST(FreeCorner, IsNowhereWhenCurvesFillTheFrame) {
  Plot::Curve zigzag{"a"};
  for (int i = 0; i <= 100; ++i) {
    zigzag.x.push_back(0.01 * i);
    zigzag.y.push_back(i % 2);
  }
  EXPECT_FALSE(free_corner(unit_panel({zigzag}), {{0}, 120.0, 60.0}));
}

// Okabe and Ito's palette differs under the colour visions that are common; here: no two curves of
// one chart look alike.
TEST(CurveStroke, DistinguishesTwentyOneCurves) {
  for (size_t i = 0; i < 21; ++i) {
    for (size_t j = 0; j < i; ++j) {
      const Stroke a = curve_stroke(i);
      const Stroke b = curve_stroke(j);
      EXPECT_TRUE(rgb_bytes(a.colour) != rgb_bytes(b.colour) || a.dashes != b.dashes);
    }
  }
}

int pixels_of_colour(const Picture& picture, const Rgb& colour, int first_row, int last_row) {
  const auto wanted = rgb_bytes(colour);
  int count = 0;
  for (int row = first_row; row < last_row; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      count += picture.pixel(column, row) == wanted ? 1 : 0;
    }
  }
  return count;
}

Plot constant_plot() {
  Plot plot;
  plot.title = "Constant";
  plot.curves = {{"", {0.0, 1.0}, {5.0, 5.0}}};
  return plot;
}

TEST(PlotPicture, DrawsAConstantAcrossTheMiddle) {
  const Picture picture = page_of(constant_plot(), {}).pixels();
  EXPECT_GT(pixels_of_colour(picture, blue, 0, picture.height), picture.width * 3 / 4);
  EXPECT_EQ(pixels_of_colour(picture, blue, 0, picture.height / 3), 0);
  EXPECT_EQ(pixels_of_colour(picture, blue, picture.height * 2 / 3, picture.height), 0);
}

// Heights as the values, and clear of the frame on both sides.
TEST(PlotPicture, DrawsBarsFromZeroInsideTheFrame) {
  Plot plot = constant_plot();
  plot.curves = {{"", {1.0}, {4.0}, {}, false, true}, {"", {2.0}, {2.0}, {}, false, true}};
  const Picture picture = page_of(plot, {}).pixels();
  const int tall = pixels_of_colour(picture, curve_stroke(0).colour, 0, picture.height);
  const int low = pixels_of_colour(picture, curve_stroke(1).colour, 0, picture.height);
  EXPECT_NEAR(static_cast<double>(tall) / low, 2.0, 0.02);
  const auto bytes = rgb_bytes(blue);
  int left = picture.width, right = 0;
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      if (picture.pixel(column, row) != bytes) continue;
      left = std::min(left, column);
      right = std::max(right, column);
    }
  }
  // The axis goes from 0.4 to 2.6 and the bar from 0.6 to 1.4; the frame takes most of the page.
  EXPECT_NEAR((right - left) / (0.9 * picture.width), 0.8 / 2.2, 0.03);
  EXPECT_GT(left, 0.1 * picture.width);
}

TEST(FreeCorner, KeepsOffBars) {
  const std::vector<Plot::Curve> full = {{"a", {0.5}, {1.0}, {}, false, true}};
  const Legend legend{{0}, 120.0, 60.0};
  EXPECT_FALSE(free_corner(unit_panel(full), legend));
  const std::vector<Plot::Curve> half = {{"a", {0.5}, {0.5}, {}, false, true}};
  EXPECT_TRUE(free_corner(unit_panel(half), legend));
}

TEST(PlotPicture, StacksPanels) {
  Plot plot = constant_plot();
  plot.below = {{"b", {{"", {0.0, 1.0}, {1.0, 2.0}}}}};
  const Picture picture = page_of(plot, {}).pixels();
  EXPECT_GT(pixels_of_colour(picture, blue, 0, picture.height / 2), 100);
  EXPECT_GT(pixels_of_colour(picture, blue, picture.height / 2, picture.height), 100);
}

TEST(PlotPicture, SurvivesEveryDegeneratePlot) {
  Plot nothing;
  Plot empty_curve = constant_plot();
  empty_curve.curves[0].x = empty_curve.curves[0].y = {};
  Plot negative_on_log = constant_plot();
  negative_on_log.x_log = negative_on_log.y_log = true;
  negative_on_log.curves[0].y = {-1.0, 0.0};
  Plot one_point_on_log = negative_on_log;
  one_point_on_log.curves[0] = {"p", {3.0}, {4.0}, {5.0}, true};
  Plot huge = constant_plot();
  huge.curves[0].y = {-1e300, 1e300};
  Plot infinite = constant_plot();
  infinite.curves[0].y = {HUGE_VAL, 1.0};
  // A constant but for rounding, whose ticks would have been counted up to 10¹⁶.
  Plot rounded_on_log = constant_plot();
  rounded_on_log.y_log = true;
  rounded_on_log.curves[0].y = {1e-6, std::nextafter(1e-6, 1.0)};
  // Ratios beyond floating point were an invalid matrix for cairo.
  Plot ends_on_log = rounded_on_log, least_on_log = rounded_on_log;
  ends_on_log.curves[0].y = {5e-324, 1.7e308};
  least_on_log.curves[0].y = {5e-324, 5e-324};
  for (const Plot& plot : {nothing, empty_curve, negative_on_log, one_point_on_log, huge, infinite,
                           rounded_on_log, ends_on_log, least_on_log}) {
    EXPECT_GT(page_of(plot, {}).pixels().height, 100);
    EXPECT_THAT(page_of(plot, {}).svg(), ::testing::HasSubstr("</svg>"));
  }
}

TEST(PlotHtml, BreaksTheLineAtAGap) {
  Plot plot = constant_plot();
  plot.curves[0].x = {0, 1, 2, 3, 4};
  plot.curves[0].y = {1, 2, std::nan(""), 2, 1};
  EXPECT_EQ(paths_of(svg_of(plot_html(plot)), "stroke", blue).size(), 2u);
}

// A page may hold many: each is a separate document, and fetches nothing.
TEST(PlotHtml, IsAnImageThatHoldsItself) {
  Plot plot = constant_plot();
  plot.title = "Rate <1 & more";
  const std::string html = plot_html(plot);
  EXPECT_THAT(html, ::testing::StartsWith(
                        "<img class=\"drawn\" alt=\"Rate &lt;1 &amp; more\" src=\"data:image/svg"));
  EXPECT_THAT(svg_of(html), ::testing::EndsWith("</svg>\n"));
  EXPECT_EQ(html, plot_html(plot)) << "equal plots give equal bytes";
}

TEST(PlotHtml, SizeDoesNotGrowWithTheRecording) {
  const auto with_samples = [](int count) {
    Plot plot;
    plot.curves.resize(2);
    plot.curves[1].dots = true;
    for (Plot::Curve& curve : plot.curves) {
      for (int i = 0; i < count; ++i) {
        curve.x.push_back(i);
        curve.y.push_back(std::sin(12345.678 * i));
      }
    }
    return plot_html(plot).size();
  };
  EXPECT_LT(with_samples(400000), 1.5 * static_cast<double>(with_samples(20000)));
}

// 1000 values from 0 to 1 and two outliers, which an axis for all of them would go to.
TEST(PlotLayout, RobustRangeLeavesOutOutliersButNoLevel) {
  Plot plot;
  plot.curves.resize(1);
  for (int i = 0; i < 1000; ++i) {
    plot.curves[0].x.push_back(i);
    plot.curves[0].y.push_back(i == 500 ? 1e6 : i == 600 ? -1e6 : 0.001 * i);
  }
  plot.robust_range = true;
  plot.levels = {-2.0};
  const AxisRange range = plot_layout(plot, {.right = 600.0}).panels.at(0).y.range;
  EXPECT_NEAR(range.high, 1.0, 0.2);
  EXPECT_NEAR(range.low, -2.0, 0.2);
}

TEST(BarChartHtml, LengthsAreProportionalAndNegativeBarsGoLeft) {
  const BarChart chart{
      "n",
      "Evidence",
      "log evidence",
      {{"best", 40.0, "", true}, {"half", 20.0, "−20 to the best"}, {"worse", -10.0}}};
  const std::string svg = svg_of(bar_chart_html(chart));
  const auto strong = paths_of(svg, "fill", blue);
  const auto plain = paths_of(svg, "fill", rgb_from_hex(0x9AA7B5));
  ASSERT_EQ(strong.size() + plain.size(), 3u);
  const auto length = [](const DrawnPath& bar) { return bar.at(1).first - bar.at(0).first; };
  EXPECT_NEAR(length(strong.at(0)) / length(plain.at(0)), 2.0, 1e-2);
  EXPECT_NEAR(length(plain.at(0)) / length(plain.at(1)), 2.0, 1e-2);
  EXPECT_NEAR(strong[0].at(0).first, plain[0].at(0).first, 0.02);
  EXPECT_NEAR(plain[1].at(1).first, strong[0].at(0).first, 0.02);
}

TEST(Legend, NamesNoCurveWithoutPoints) {
  const std::vector<Plot::Curve> curves = {{"seen", {0.0, 1.0}, {1.0, 2.0}}, {"empty", {}, {}}};
  EXPECT_EQ(legend_of(curves, 170.0).curves, std::vector<size_t>{0});
}

// 600 s are the first minutes, 2 h the first hours, 3 d the first days.
TEST(TimeAxis, HasTheUnitOfItsLength) {
  const auto drawn = [](double duration_s, const char* label) {
    Plot plot;
    plot.x_label = label;
    plot.curves = {{"", {0.0, duration_s}, {1.0, 2.0}}};
    plot.below = {{"y", {{"", {0.0, duration_s}, {1.0, 2.0}}}}};
    plot.shaded = {{0.5 * duration_s, duration_s}};
    return with_readable_time_unit(plot);
  };
  const std::vector<std::tuple<double, const char*, double>> known = {
      {599.0, "time [s]", 599.0},
      {600.0, "time [min]", 10.0},
      {7199.0, "time [min]", 7199.0 / 60},
      {86400.0, "time [h]", 24.0},
      {259200.0, "time [d]", 3.0}};
  for (const auto& [duration_s, label, end] : known) {
    const Plot plot = drawn(duration_s, "time [s]");
    EXPECT_EQ(plot.x_label, label);
    EXPECT_DOUBLE_EQ(plot.curves[0].x[1], end);
    EXPECT_DOUBLE_EQ(plot.below[0].curves[0].x[1], end);
    EXPECT_DOUBLE_EQ(plot.shaded[0].to, end);
    EXPECT_DOUBLE_EQ(end * seconds_of_unit(plot), duration_s);
  }
  EXPECT_EQ(drawn(1e6, "Voltage [V]").curves[0].x[1], 1e6);
}

// A band up to the corner that the legend takes: the label of the band stands elsewhere.
TEST(Plot, LegendsDoNotCoverTheLabelOfABand) {
  Plot plot{"p", "p", "x", "y"};
  plot.curves = {{"measured", {0.0, 1.0}, {1.0, 0.0}}, {"model", {0.0, 1.0}, {0.9, 0.1}}};
  plot.shaded = {{0.5, 1.0}};
  plot.shaded_label = "held out";
  const std::string page = page_of(plot, {}).svg();
  const auto height_of = [&](const std::string& text) {
    const std::regex element("translate\\([0-9.-]+ ([0-9.-]+)\\)[^>]*>" + text + "</text>");
    std::smatch found;
    EXPECT_TRUE(std::regex_search(page, found, element)) << text;
    return found.empty() ? 0.0 : std::stod(found[1]);
  };
  EXPECT_LT(height_of("measured"), height_of("model"));
  EXPECT_GT(height_of("held out"), height_of("model") + 12.0);
}

// Forty bars of 100 and of 30 before them: the colours share the picture like that, without gaps.
TEST(Plot, ManyBarsStandOnEachOther) {
  Plot plot;
  plot.name = plot.title = "shares";
  for (const double top : {100.0, 30.0}) {
    Plot::Curve curve;
    for (int i = 0; i < 40; ++i) {
      curve.x.push_back(2.5 * i);
      curve.y.push_back(top);
    }
    curve.bars = true;
    plot.curves.push_back(curve);
  }
  const Picture picture = page_of(plot, {}).pixels();
  std::array<double, 2> pixels{};
  for (size_t i = 0; i < picture.rgb.size(); i += 3) {
    for (size_t k = 0; k < 2; ++k) {
      const auto colour = rgb_bytes(curve_stroke(k).colour);
      pixels[k] += std::abs(picture.rgb[i] - colour[0]) < 4 &&
                   std::abs(picture.rgb[i + 1] - colour[1]) < 4 &&
                   std::abs(picture.rgb[i + 2] - colour[2]) < 4;
    }
  }
  EXPECT_NEAR(pixels[1] / (pixels[0] + pixels[1]), 0.3, 0.01);
  // 1200 by 660 pixels within the axes, at 6 % room above.
  EXPECT_GT(pixels[0] + pixels[1], 0.8 * 0.94 * 1100 * 650);
}

TEST(Styles, PaperHasNoTitleAndRelativelyLargerLetters) {
  Plot plot = constant_plot();
  plot.title = "A long title";
  const std::string page = page_of(plot, {}).svg(),
                    paper = page_of(plot, {}, PictureStyle::paper).svg();
  EXPECT_THAT(page, ::testing::HasSubstr(">" + plot.title + "</text>"));
  EXPECT_THAT(paper, ::testing::Not(::testing::HasSubstr(plot.title)));
  const auto width = [](const std::string& svg) {
    return std::stod(svg.substr(svg.find("width=\"") + 7));
  };
  EXPECT_NEAR(width(paper) / width(page), 0.62, 0.01);
  // Letters have their size in points in both.
  EXPECT_THAT(paper, ::testing::HasSubstr("font-size=\"10.50\""));
  const Picture slide = page_of(plot, {}, PictureStyle::slide).pixels();
  EXPECT_GT(slide.width, page_of(plot, {}).pixels().width);
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line;
  std::erase(text, ' ');
  return text;
}

TEST(FittedText, NeverIsWiderThanItsRoom) {
  std::mt19937 generator(11);
  for (int i = 0; i < 300; ++i) {
    std::string text;
    for (unsigned n = generator() % 60; n > 0; --n) text += generator() % 6 == 0 ? " " : "µé";
    const double width = 40.0 + generator() % 200;
    const TextBlock block = fitted_text(text, width, {.size = 14.0}, 9.0, 3);
    EXPECT_LE(block.lines.size(), 3u);
    for (const std::string& line : block.lines) {
      EXPECT_LE(text_width(line, block.style), width + 1e-9) << line;
      EXPECT_EQ(clean_text(line), line) << "a character was cut in two";
    }
    const bool shortened = block.lines.back().ends_with("…");
    EXPECT_TRUE(shortened || joined(block.lines) == joined({text}));
  }
}

TEST(FittedText, ShrinksBeforeItShortens) {
  const std::string text = "Irradiance on the solar array of the platform";
  const TextStyle style{.size = 15.0};
  const double exact = text_width(text, style);
  EXPECT_EQ(fitted_text(text, exact, style, 8.0, 1).style.size, 15.0);
  const TextBlock smaller = fitted_text(text, 0.7 * exact, style, 8.0, 1);
  EXPECT_LT(smaller.style.size, 15.0);
  EXPECT_EQ(smaller.lines, std::vector<std::string>{text});
  EXPECT_TRUE(fitted_text(text, 0.3 * exact, style, 8.0, 1).lines[0].ends_with("…"));
}

}  // namespace
}  // namespace photorque
