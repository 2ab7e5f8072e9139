// A numbered axis of a chart: positions and format of its numbers.
#pragma once

#include <string>
#include <vector>

#include "images/drawing/canvas.h"

namespace photorque {

// `labels[i]` is values[i] / 10^exponent. All labels have equal decimals and a true minus sign. The
// exponent is a multiple of 3, and 0 if plain numbers are readable.
struct Ticks {
  std::vector<double> values;
  std::vector<std::string> labels;
  int exponent = 0;
};

// Multiples of 1, 2 or 5 · 10^k within [low, high]: as many as possible, at most `at_most` (≥ 2).
// Requires finite low < high.
// Source: P. Heckbert, "Nice numbers for graph labels", Graphics Gems (1990).
Ticks linear_ticks(double low, double high, int at_most);

// Powers of ten within [low, high], every one or every n-th; if there are fewer than two, also 2
// and 5 times these. Labels are "10⁻³" or plain numbers. Requires 0 < low < high.
Ticks log_ticks(double low, double high, int at_most);

// Bounds that linear_ticks accepts. Widens an empty, reversed or too narrow interval, so that a
// constant is drawn as a line in the middle.
struct AxisRange {
  double low = 0.0;
  double high = 1.0;
};
AxisRange drawable(AxisRange interval);

// Length of a tick on every axis, in page units.
inline constexpr double tick_length = 4.0;

struct Axis {
  AxisRange range;
  bool log = false;
  Ticks ticks;
  std::string label;  // the unit in brackets contains the ticks' power of ten: "torque [×10⁻⁹ N m]"

  // 0 at range.low, 1 at range.high; NaN for values that a logarithmic axis cannot show.
  double fraction(double value) const;
};

inline constexpr TextStyle tick_style{.size = 10.5};
inline constexpr TextStyle label_style{.size = 12.0};

// Axes of `length` points with as many numbers as fit without touching. A logarithmic axis requires
// a positive range; a linear one is made drawable().
Axis horizontal_axis(AxisRange range, bool log, const std::string& label, double length);
Axis vertical_axis(AxisRange range, bool log, const std::string& label, double length);

// Space [points] for numbers and label below a horizontal or left of a vertical axis.
double horizontal_axis_height(const Axis& axis);
double tick_labels_width(const Axis& axis);
double vertical_axis_width(const Axis& axis);

// Draws ticks, numbers and label along the bottom or the left edge of `frame`.
void draw_horizontal_axis(Canvas& canvas, const PageBox& frame, const Axis& axis);
// `label_room` is the distance from the frame to the far side of the label; it is equal for stacked
// panels.
void draw_vertical_axis(Canvas& canvas, const PageBox& frame, const Axis& axis, double label_room);

// Unit with a power of ten: "W/m²" with exponent −9 is "×10⁻⁹ W/m²".
std::string unit_with_power(const std::string& unit, int exponent);

}  // namespace photorque
