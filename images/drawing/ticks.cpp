#include "images/drawing/ticks.h"

#include <array>
#include <cmath>
#include <cstdlib>

#include "core/text/format.h"

namespace photorque {
namespace {

// Ten to an integer power, correctly rounded where std::pow need not be.
double ten_to(int exponent) {
  return std::strtod(("1e" + std::to_string(exponent)).c_str(), nullptr);
}

struct Step {
  int mantissa = 1;  // 1, 2 or 5
  int exponent = 0;
  double size() const {
    return exponent < 0 ? mantissa / ten_to(-exponent) : mantissa * ten_to(exponent);
  }
  double multiple(double n) const {  // n·size, rounded once
    return exponent < 0 ? n * mantissa / ten_to(-exponent) : n * mantissa * ten_to(exponent);
  }
};

// Counts of steps from zero to the first and the last tick; the ends forgive rounding.
struct Span {
  double first = 0.0;
  double last = 0.0;
};

Span span_of(double low, double high, const Step& step) {
  const double slack = 1e-9 * (high - low) / step.size();
  return {std::ceil(low / step.size() - slack), std::floor(high / step.size() + slack)};
}

Step next(const Step& step) {
  switch (step.mantissa) {
    case 1:
      return {2, step.exponent};
    case 2:
      return {5, step.exponent};
    default:
      return {1, step.exponent + 1};
  }
}

int engineering_exponent(double largest) {
  if (largest == 0.0 || (largest >= 1e-2 && largest < 1e5)) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(largest * (1 + 1e-12)) / 3.0));
}

std::string tick_label(double scaled, int decimals) {
  std::array<char, 400> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, std::abs(scaled));
  const std::string digits = buffer.data();
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return scaled < 0.0 && !zero ? "−" + digits : digits;
}

}  // namespace

Ticks linear_ticks(double low, double high, int at_most) {
  Step step{1, static_cast<int>(std::floor(std::log10((high - low) / at_most))) - 1};
  Span span = span_of(low, high, step);
  while (span.last - span.first + 1 > at_most) {
    step = next(step);
    span = span_of(low, high, step);
  }
  Ticks ticks;
  for (double n = span.first; n <= span.last; ++n) ticks.values.push_back(step.multiple(n));
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
  if (!std::isfinite(low) || !std::isfinite(high)) return {0.0, 1.0};
  if (low > high) std::swap(low, high);
  const double magnitude = std::max(std::abs(low), std::abs(high));
  if (magnitude == 0.0) return {-1.0, 1.0};
  if (high - low > 1e-9 * magnitude) return {low, high};
  const double middle = low + 0.5 * (high - low);
  return {middle - 0.1 * magnitude, middle + 0.1 * magnitude};
}

}  // namespace photorque
