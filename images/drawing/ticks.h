// Where an axis carries numbers, and how they are written.
#pragma once

#include <string>
#include <vector>

namespace photorque {

// `labels[i]` is values[i] / 10^exponent, written with the same decimals as its neighbours and a
// true minus sign; exponent is a multiple of 3, and 0 where plain numbers read well.
struct Ticks {
  std::vector<double> values;
  std::vector<std::string> labels;
  int exponent = 0;
};

// Multiples of 1, 2 or 5 · 10^k within [low, high]: as many as possible, not more than `at_most`
// (≥ 2). Needs finite low < high.
// Source: P. Heckbert, "Nice numbers for graph labels", Graphics Gems (1990).
Ticks linear_ticks(double low, double high, int at_most);

// Powers of ten within [low, high], every one or every n-th; where there are fewer than two, also
// 2 and 5 times them. Labels are "10⁻³" or plain numbers. Needs 0 < low < high.
Ticks log_ticks(double low, double high, int at_most);

// Bounds that linear_ticks accepts and that show a constant as a line in the middle: widens an
// empty, reversed or rounding-narrow interval.
struct AxisRange {
  double low = 0.0;
  double high = 1.0;
};
AxisRange drawable(AxisRange interval);

}  // namespace photorque
