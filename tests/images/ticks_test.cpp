#include <gtest/gtest.h>

#include <random>

#include "images/drawing/axis.h"

namespace photorque {
namespace {

// Intervals of all sizes, signs and ratios of offset to width.
std::vector<AxisRange> many_ranges() {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<AxisRange> ranges;
  for (int i = 0; i < 3000; ++i) {
    const double width = std::pow(10.0, 15.0 * uniform(generator));
    const double low = width * 300.0 * std::pow(uniform(generator), 5);
    ranges.push_back({low, low + width});
  }
  return ranges;
}

// The number that a reader takes from a label.
double parsed(std::string label) {
  const size_t minus = label.find("−");
  if (minus != std::string::npos) label.replace(minus, std::string("−").size(), "-");
  return std::stod(label);
}

TEST(LinearTicks, StepsAreOneTwoOrFive) {
  for (const AxisRange& range : many_ranges()) {
    const Ticks ticks = linear_ticks(range.low, range.high, 8);
    ASSERT_GE(ticks.values.size(), 2u);
    const double step =
        (ticks.values.back() - ticks.values.front()) / static_cast<double>(ticks.values.size() - 1);
    const double mantissa = step / std::pow(10.0, std::floor(std::log10(step * 1.0001)));
    EXPECT_TRUE(std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 ||
                std::abs(mantissa - 5) < 1e-6)
        << range.low << " " << range.high << " " << mantissa;
  }
}

// 0.4 to 1.6 of a step holds one multiple of it; a scale needs two.
TEST(LinearTicks, AreNeverAlone) {
  for (const AxisRange& range : many_ranges()) {
    for (const int at_most : {2, 3, 4, 9}) {
      const Ticks ticks = linear_ticks(range.low, range.high, at_most);
      EXPECT_GE(ticks.values.size(), 2u) << range.low << " " << range.high << " " << at_most;
      EXPECT_LE(static_cast<int>(ticks.values.size()), at_most);
    }
  }
}

TEST(LinearTicks, FillTheIntervalWithoutLeavingIt) {
  for (const AxisRange& range : many_ranges()) {
    const double width = range.high - range.low;
    for (const int at_most : {2, 5, 11}) {
      const Ticks ticks = linear_ticks(range.low, range.high, at_most);
      EXPECT_LE(static_cast<int>(ticks.values.size()), at_most);
      for (const double value : ticks.values) {
        EXPECT_GE(value, range.low - 1e-8 * width);
        EXPECT_LE(value, range.high + 1e-8 * width);
      }
      // The next denser step is at most 2.5 times finer and has too many.
      EXPECT_GE(static_cast<int>(ticks.values.size()), (at_most + 1 - 1) / 2.5 - 1.0);
    }
  }
}

TEST(LinearTicks, LabelsContainTheValues) {
  for (const AxisRange& range : many_ranges()) {
    const Ticks ticks = linear_ticks(range.low, range.high, 8);
    EXPECT_EQ(ticks.exponent % 3, 0);
    ASSERT_EQ(ticks.labels.size(), ticks.values.size());
    for (size_t i = 0; i < ticks.values.size(); ++i) {
      EXPECT_NEAR(parsed(ticks.labels[i]) * std::pow(10.0, ticks.exponent), ticks.values[i],
                  1e-6 * (range.high - range.low))
          << ticks.labels[i];
    }
  }
}

TEST(LinearTicks, ReadAsPeopleWriteThem) {
  using ::testing::ElementsAre;
  EXPECT_THAT(linear_ticks(-0.25, 0.25, 6).labels,
              ElementsAre("−0.2", "−0.1", "0.0", "0.1", "0.2"));
  const Ticks torque = linear_ticks(0.0, 1.2e-9, 5);
  EXPECT_EQ(torque.exponent, -9);
  EXPECT_THAT(torque.labels, ElementsAre("0.0", "0.5", "1.0"));
  EXPECT_THAT(linear_ticks(0.0, 1361.0, 8).labels,
              ElementsAre("0", "200", "400", "600", "800", "1000", "1200"));
  EXPECT_EQ(unit_with_power("N m", -9), "×10⁻⁹ N m");
}

TEST(LogTicks, ArePowersOfTenOverDecades) {
  using ::testing::ElementsAre;
  EXPECT_THAT(log_ticks(1e-3, 1e2, 9).labels,
              ElementsAre("10⁻³", "10⁻²", "10⁻¹", "1", "10", "10²"));
  EXPECT_THAT(log_ticks(0.9e-3, 3e2, 3).values, ElementsAre(1e-3, 1e-1, 1e1));
  EXPECT_THAT(log_ticks(1.5, 9.0, 9).labels, ElementsAre("2", "5"));
}

// The range of a map that holds one value, of a plot of a constant, of an empty plot.
TEST(Drawable, MakesEveryIntervalUsable) {
  const double nan = std::nan("");
  for (const AxisRange& range :
       {AxisRange{5, 5}, AxisRange{0, 0}, AxisRange{2, 1}, AxisRange{nan, 1},
        AxisRange{-1e-300, 1e-300}, AxisRange{1361, 1361 * (1 + 1e-15)}, AxisRange{-4e7, -4e7},
        AxisRange{0, 5e-324}}) {
    const AxisRange usable = drawable(range);
    EXPECT_LT(usable.low, usable.high);
    EXPECT_GE(linear_ticks(usable.low, usable.high, 8).values.size(), 2u);
    if (std::isfinite(range.low)) {
      EXPECT_LE(usable.low, std::min(range.low, range.high));
      EXPECT_GE(usable.high, std::max(range.low, range.high));
    }
  }
}

// Numbers over the whole range of floating point.
TEST(Drawable, StepsStayFinite) {
  const AxisRange usable = drawable({-1.7e308, 1.7e308});
  EXPECT_TRUE(std::isfinite(usable.high - usable.low));
  EXPECT_GE(linear_ticks(usable.low, usable.high, 8).values.size(), 2u);
}

TEST(HorizontalAxis, NumbersNeverTouch) {
  for (const AxisRange& range : many_ranges()) {
    constexpr double length = 150.0;
    const Axis axis = horizontal_axis(range, false, "x [m]", length);
    double previous_end = -1e300;
    if (axis.ticks.values.size() <= 2) continue;  // fewer cannot be asked for
    for (size_t i = 0; i < axis.ticks.values.size(); ++i) {
      const double width = text_width(axis.ticks.labels[i], tick_style);
      const double centre = length * axis.fraction(axis.ticks.values[i]);
      EXPECT_GT(centre - 0.5 * width, previous_end);
      previous_end = centre + 0.5 * width;
    }
  }
}

}  // namespace
}  // namespace photorque
