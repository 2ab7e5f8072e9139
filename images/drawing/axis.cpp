#include "images/drawing/axis.h"

#include <cmath>
#include <cstdlib>
#include "core/text/format.h"
#include "images/drawing/page_layout.h"

namespace photorque {
namespace {

// Integer power of ten, correctly rounded, which std::pow does not guarantee.
double ten_to(int exponent) {
  return std::strtod(("1e" + std::to_string(exponent)).c_str(), nullptr);
}

struct Step {
  int mantissa = 1;  // 1, 2 or 5
  int exponent = 0;
  double size() const { return multiple(1.0); }
  double multiple(double n) const {  // n·size, rounded once
    return exponent < 0 ? n * mantissa / ten_to(-exponent) : n * mantissa * ten_to(exponent);
  }
  Step next() const {
    return mantissa == 5 ? Step{1, exponent + 1} : Step{mantissa == 1 ? 2 : 5, exponent};
  }
};

// First and last tick as multiples of the step; tolerates rounding at the ends.
struct Span {
  double first = 0.0;
  double last = 0.0;
};

Span span_of(double low, double high, const Step& step) {
  const double slack = 1e-9 * (high - low) / step.size();
  return {std::ceil(low / step.size() - slack), std::floor(high / step.size() + slack)};
}

int engineering_exponent(double largest) {
  if (largest == 0.0 || (largest >= 1e-2 && largest < 1e5)) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(largest * (1 + 1e-12)) / 3.0));
}

std::string tick_label(double scaled, int decimals) {
  const std::string digits = printed("%.*f", decimals, std::abs(scaled));
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return scaled < 0.0 && !zero ? "−" + digits : digits;
}

constexpr double gap = 3.0;

std::string label_with_power(const std::string& label, int exponent) {
  if (exponent == 0) return label;
  const std::string power = "×" + power_of_ten(exponent);
  const size_t bracket = label.rfind('[');
  if (bracket == std::string::npos) return label + (label.empty() ? "" : " ") + power;
  std::string result = label;
  const bool without_unit = label.compare(bracket, 2, "[]") == 0;
  return result.insert(bracket + 1, power + (without_unit ? "" : " "));
}

// Ticks of angles over more than 60 deg: multiples of 15, 30, 45 or 90 deg. Empty for other axes.
std::optional<Ticks> turn_ticks(const AxisRange& range, const std::string& label, int at_most) {
  const double span = range.high - range.low;
  if (!label.ends_with("[deg]") || !(span > 60.0) || span > 720.0) return std::nullopt;
  for (const int step : {15, 30, 45, 90}) {
    Ticks ticks;
    const double slack = 1e-9 * span / step;
    for (double n = std::ceil(range.low / step - slack); n * step <= range.high + slack * step;
         ++n) {
      const int value = static_cast<int>(std::lround(n * step));
      ticks.values.push_back(value);
      ticks.labels.push_back((value < 0 ? "−" : "") + std::to_string(std::abs(value)));
    }
    if (static_cast<int>(ticks.values.size()) <= at_most) return ticks;
  }
  return std::nullopt;
}

Axis axis_with(const AxisRange& range, bool log, const std::string& label, int at_most) {
  Axis axis{range, log, {}, ""};
  axis.ticks = log ? log_ticks(range.low, range.high, at_most)
                   : turn_ticks(range, label, std::max(at_most, 5))
                         .value_or(linear_ticks(range.low, range.high, at_most));
  axis.label = label_with_power(label, axis.ticks.exponent);
  return axis;
}

// Whether neighbouring numbers do not overlap along a horizontal axis.
bool numbers_fit(const Axis& axis, double length) {
  double previous_end = -1e300;
  for (size_t i = 0; i < axis.ticks.values.size(); ++i) {
    const double width = text_width(axis.ticks.labels[i], tick_style);
    const double centre = length * axis.fraction(axis.ticks.values[i]);
    if (centre - 0.5 * width < previous_end + 8.0) return false;
    previous_end = centre + 0.5 * width;
  }
  return true;
}

}  // namespace

Ticks linear_ticks(double low, double high, int at_most) {
  Step step{1, static_cast<int>(std::floor(std::log10((high - low) / at_most))) - 1};
  Span span = span_of(low, high, step);
  const auto count = [](const Span& of) { return of.last - of.first + 1; };
  double every = 1.0;
  while (count(span) > at_most) {
    const Step larger = step.next();
    const Span fewer = span_of(low, high, larger);
    // A single number does not define a scale. Use some numbers of the smaller step instead.
    if (count(fewer) < 2) {
      every = std::ceil(count(span) / std::max(2, at_most));
      break;
    }
    step = larger;
    span = fewer;
  }
  Ticks ticks;
  for (double n = span.first; n <= span.last; n += every) ticks.values.push_back(step.multiple(n));
  ticks.exponent =
      engineering_exponent(step.multiple(std::max(std::abs(span.first), std::abs(span.last))));
  const int decimals = std::max(0, ticks.exponent - step.exponent);
  for (const double value : ticks.values) {
    ticks.labels.push_back(tick_label(value / std::pow(10.0, ticks.exponent), decimals));
  }
  return ticks;
}

Ticks log_ticks(double low, double high, int at_most) {
  const int first = static_cast<int>(std::ceil(std::log10(low) - 1e-9));
  const int last = static_cast<int>(std::floor(std::log10(high) + 1e-9));
  const int decades = last - first + 1;
  Ticks ticks;
  if (decades >= 2) {
    const int every = std::max(1, (decades + at_most - 1) / at_most);
    for (int e = first; e <= last; e += every) {
      ticks.values.push_back(std::pow(10.0, e));
      ticks.labels.push_back(e == 0 ? "1" : e == 1 ? "10" : power_of_ten(e));
    }
    return ticks;
  }
  for (int e = first - 1; e <= last; ++e) {
    for (const double mantissa : {1.0, 2.0, 5.0}) {
      const double value = mantissa * std::pow(10.0, e);
      if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
      ticks.values.push_back(value);
      ticks.labels.push_back(readable_number(value, 1));
    }
  }
  if (ticks.values.size() >= 2) return ticks;
  return linear_ticks(low, high, at_most);
}

AxisRange drawable(AxisRange interval) {
  auto [low, high] = interval;
  // Beyond these values the steps between ticks are infinite or lose their digits.
  constexpr double least = 1e-280, most = 1e280;
  if (!std::isfinite(low) || !std::isfinite(high)) return {0.0, 1.0};
  if (low > high) std::swap(low, high);
  const double magnitude = std::max(std::abs(low), std::abs(high));
  if (magnitude < least) return {-1.0, 1.0};
  if (magnitude > most) return {-most, most};
  if (high - low > 1e-9 * magnitude) return {low, high};
  const double middle = low + 0.5 * (high - low);
  return {middle - 0.1 * magnitude, middle + 0.1 * magnitude};
}

double Axis::fraction(double value) const {
  if (!log) return (value - range.low) / (range.high - range.low);
  // Limited, so that a value far beyond the axis has a finite position.
  return std::log(std::min(value / range.low, 1e300)) / std::log(range.high / range.low);
}

Axis horizontal_axis(AxisRange range, bool log, const std::string& label, double length) {
  const AxisRange shown = log ? range : drawable(range);
  for (int at_most = std::clamp(static_cast<int>(length / 40.0), 2, 11);; --at_most) {
    Axis axis = axis_with(shown, log, label, at_most);
    if (at_most <= 2 || numbers_fit(axis, length)) return axis;
  }
}

Axis vertical_axis(AxisRange range, bool log, const std::string& label, double length) {
  const int at_most = std::clamp(static_cast<int>(length / 28.0), 3, 9);
  return axis_with(log ? range : drawable(range), log, label, at_most);
}

double horizontal_axis_height(const Axis& axis) {
  return tick_length + gap + tick_style.size +
         (axis.label.empty() ? 0.0 : 2.0 * gap + label_style.size);
}

double tick_labels_width(const Axis& axis) {
  double widest = 0.0;
  for (const std::string& label : axis.ticks.labels) {
    widest = std::max(widest, text_width(label, tick_style));
  }
  return tick_length + gap + widest;
}

double vertical_axis_width(const Axis& axis) {
  return tick_labels_width(axis) + (axis.label.empty() ? 0.0 : 2.0 * gap + label_style.size);
}

void draw_horizontal_axis(Canvas& canvas, const PageBox& frame, const Axis& axis) {
  TextStyle style = tick_style;
  style.align = TextAlign::centre;
  for (size_t i = 0; i < axis.ticks.values.size(); ++i) {
    const double x = frame.x + frame.width * axis.fraction(axis.ticks.values[i]);
    canvas.line({x, frame.bottom()}, {x, frame.bottom() + tick_length}, {ink, 0.8});
    canvas.text(axis.ticks.labels[i], {x, frame.bottom() + tick_length + gap + 0.8 * style.size},
                style);
  }
  TextStyle label = label_style;
  label.align = TextAlign::centre;
  canvas.text(axis.label, {frame.centre().x, frame.bottom() + horizontal_axis_height(axis)}, label);
}

void draw_vertical_axis(Canvas& canvas, const PageBox& frame, const Axis& axis, double label_room) {
  TextStyle style = tick_style;
  style.align = TextAlign::right;
  style.level = TextLevel::middle;
  for (size_t i = 0; i < axis.ticks.values.size(); ++i) {
    const double y = frame.bottom() - frame.height * axis.fraction(axis.ticks.values[i]);
    canvas.line({frame.x - tick_length, y}, {frame.x, y}, {ink, 0.8});
    canvas.text(axis.ticks.labels[i], {frame.x - tick_length - gap, y}, style);
  }
  if (axis.label.empty()) return;
  TextStyle label = label_style;
  label.align = TextAlign::centre;
  label.turn_rad = quarter_turn_rad;
  const TextBlock fitted = fitted_text(axis.label, frame.height + 20.0, label, 8.5, 1);
  canvas.text(fitted.lines.front(), {frame.x - label_room + label_style.size, frame.centre().y},
              fitted.style);
}

std::string unit_with_power(const std::string& unit, int exponent) {
  if (exponent == 0) return unit;
  return "×" + power_of_ten(exponent) + (unit.empty() ? "" : " " + unit);
}

}  // namespace photorque
