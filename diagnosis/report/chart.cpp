#include "diagnosis/report/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "diagnosis/report/text.h"

namespace photorque {
namespace {

constexpr double page_width = 920.0;
constexpr double left = 86.0, right = 12.0, top = 8.0;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string text_at(double x, double y, const std::string& text, const std::string& anchor,
                    const std::string& more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" +
         more + ">" + html(text) + "</text>\n";
}

std::string line_at(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) +
         "\" y2=\"" + number(y2) + "\" " + style + "/>\n";
}

struct Range {
  double low = 0.0, high = 1.0;
  double at(double value, double from, double to) const {
    return from + (to - from) * (value - low) / (high - low);
  }
};

// Multiples of 1, 2 or 5 · 10^k (P. Heckbert, "Nice numbers for graph labels", 1990).
std::vector<double> ticks_of(const Range& range, int at_most) {
  const double rough = (range.high - range.low) / at_most;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double m : {1.0, 2.0, 5.0}) {
    if (m * power >= rough * (1.0 - 1e-9)) {
      step = m * power;
      break;
    }
  }
  std::vector<double> ticks;
  for (double i = std::ceil(range.low / step - 1e-9); i * step <= range.high + 1e-9 * step; ++i) {
    ticks.push_back(i * step);
  }
  return ticks;
}

// Labels of one axis with a common number of decimals and a common power of ten.
struct TickLabels {
  std::vector<std::string> texts;
  int exponent = 0;
};
TickLabels labels_of(const std::vector<double>& ticks) {
  TickLabels labels;
  double largest = 0.0, step = 1.0;
  for (const double t : ticks) largest = std::max(largest, std::abs(t));
  if (ticks.size() > 1) step = ticks[1] - ticks[0];
  if (largest > 0.0 && (largest < 1e-2 || largest >= 1e5)) {
    labels.exponent = 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0));
  }
  const double scale = std::pow(10.0, labels.exponent);
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step / scale) + 1e-9)));
  for (const double t : ticks) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*f", decimals, std::abs(t) < 1e-9 * step ? 0.0 : t / scale);
    labels.texts.push_back(text[0] == '-' ? "−" + std::string(text + 1) : text);
  }
  return labels;
}

// "[rad/s]" with exponent −3 is "[10⁻³ rad/s]".
std::string with_power(std::string label, int exponent) {
  if (exponent == 0) return label;
  std::string power = plain_number(std::pow(10.0, exponent > 4 || exponent < -3 ? exponent : 0), 1);
  const size_t ten = power.find("10");
  power = exponent == -3 ? "10⁻³" : ten == std::string::npos ? "×" + power : power.substr(ten);
  const size_t bracket = label.find('[');
  return bracket == std::string::npos ? label + " [" + power + "]"
                                      : label.insert(bracket + 1, power + " ");
}

void widen(Range& range, double value) {
  range.low = std::min(range.low, value);
  range.high = std::max(range.high, value);
}

Range x_range(const LineChart& chart) {
  Range range{1e300, -1e300};
  for (const ChartLine& line : chart.lines) {
    for (const double x : line.x) {
      if (std::isfinite(x)) widen(range, x);
    }
  }
  if (!(range.low < range.high)) return {0.0, 1.0};
  return range;
}

Range y_range(const LineChart& chart) {
  std::vector<double> all = chart.levels;
  for (const ChartLine& line : chart.lines) {
    for (size_t i = 0; i < line.y.size(); ++i) {
      if (!std::isfinite(line.y[i])) continue;
      const double error = line.error.empty() ? 0.0 : line.error[i];
      all.push_back(line.y[i] - error);
      all.push_back(line.y[i] + error);
    }
  }
  if (all.empty()) return {0.0, 1.0};
  std::ranges::sort(all);
  const size_t skip = chart.robust_range ? all.size() / 500 : 0;
  Range range{all[skip], all[all.size() - 1 - skip]};
  for (const double level : chart.levels) widen(range, level);
  const double margin = 0.05 * (range.high - range.low);
  if (margin > 0.0) return {range.low - margin, range.high + margin};
  const double room = range.low == 0.0 ? 1.0 : 0.1 * std::abs(range.low);
  return {range.low - room, range.high + room};
}

// Frame, scales and what is drawn in them.
class Drawing {
 public:
  explicit Drawing(const LineChart& chart)
      : chart_(chart), x_(x_range(chart)), y_(y_range(chart)), bottom_(top + chart.height) {}

  std::string shading() const {
    std::string svg;
    bool labelled = false;
    for (const auto& [from, to] : chart_.shaded) {
      const double a = std::clamp(x(from), left, page_width - right);
      const double b = std::clamp(x(to), left, page_width - right);
      if (!(b > a)) continue;
      svg += "<rect x=\"" + number(a) + "\" y=\"" + number(top) + "\" width=\"" + number(b - a) +
             "\" height=\"" + number(chart_.height) + "\" fill=\"" + report_colour::shade +
             "\"/>\n";
      if (!labelled && b - a > 60.0 && !chart_.shade_label.empty()) {
        svg += text_at(b - 6.0, top + 15.0, chart_.shade_label, "end", " class=\"note\"");
        labelled = true;
      }
    }
    return svg;
  }

  std::string axes() const {
    std::string svg;
    const std::vector<double> y_ticks = ticks_of(y_, chart_.height > 120 ? 6 : 4);
    const TickLabels y_labels = labels_of(y_ticks);
    for (size_t i = 0; i < y_ticks.size(); ++i) {
      svg += line_at(left, y(y_ticks[i]), page_width - right, y(y_ticks[i]), "class=\"grid\"");
      svg += text_at(left - 7.0, y(y_ticks[i]) + 4.0, y_labels.texts[i], "end");
    }
    const double middle = 0.5 * (top + bottom_);
    svg += text_at(15.0, middle, with_power(chart_.y_label, y_labels.exponent), "middle",
                   " transform=\"rotate(-90 15 " + number(middle) + ")\"");
    svg += "<rect x=\"" + number(left) + "\" y=\"" + number(top) + "\" width=\"" +
           number(page_width - left - right) + "\" height=\"" + number(chart_.height) +
           "\" class=\"frame\"/>\n";
    const std::vector<double> x_ticks = ticks_of(x_, 10);
    const TickLabels x_labels = labels_of(x_ticks);
    for (size_t i = 0; i < x_ticks.size(); ++i) {
      svg += line_at(x(x_ticks[i]), bottom_, x(x_ticks[i]), bottom_ + 4.0, "class=\"tick\"");
      if (chart_.with_x_axis) {
        svg += text_at(x(x_ticks[i]), bottom_ + 17.0, x_labels.texts[i], "middle");
      }
    }
    if (chart_.with_x_axis) {
      svg += text_at(0.5 * (left + page_width - right), bottom_ + 35.0,
                     with_power(chart_.x_label, x_labels.exponent), "middle");
    }
    return svg;
  }

  std::string levels() const {
    std::string svg;
    for (const double level : chart_.levels) {
      svg += line_at(left, y(level), page_width - right, y(level), "class=\"level\"");
    }
    return svg;
  }

  std::string curve(const ChartLine& line) const {
    return band(line) + (line.dots ? dots(line) : path(line));
  }

  double total_height() const { return bottom_ + (chart_.with_x_axis ? 42.0 : 8.0); }

 private:
  double x(double value) const { return x_.at(value, left, page_width - right); }
  double y(double value) const { return y_.at(value, bottom_, top); }

  // At most four points per pixel of x: first, lowest, highest, last.
  std::vector<size_t> thinned(const ChartLine& line) const {
    std::vector<size_t> kept;
    const size_t n = line.x.size();
    for (size_t i = 0; i < n;) {
      size_t end = i, low = i, high = i;
      const double pixel = std::floor(x(line.x[i]));
      while (end < n && std::floor(x(line.x[end])) == pixel && std::isfinite(line.y[end])) {
        if (line.y[end] < line.y[low]) low = end;
        if (line.y[end] > line.y[high]) high = end;
        ++end;
      }
      if (end == i) {
        kept.push_back(i++);  // a gap
        continue;
      }
      std::vector<size_t> some = {i, low, high, end - 1};
      std::ranges::sort(some);
      some.erase(std::ranges::unique(some).begin(), some.end());
      kept.insert(kept.end(), some.begin(), some.end());
      i = end;
    }
    return kept;
  }

  std::string path(const ChartLine& line) const {
    std::string d;
    bool pen_down = false;
    for (const size_t i : thinned(line)) {
      if (!std::isfinite(line.y[i]) || !std::isfinite(line.x[i])) {
        pen_down = false;
        continue;
      }
      d += (pen_down ? "L" : "M") + number(x(line.x[i])) + " " + number(clipped(line.y[i]));
      pen_down = true;
    }
    return "<path d=\"" + d + "\" fill=\"none\" stroke=\"" + line.colour + "\" stroke-width=\"" +
           number(line.width) + "\"" + (line.dashed ? " stroke-dasharray=\"6 4\"" : "") + "/>\n";
  }

  std::string dots(const ChartLine& line) const {
    std::string d;
    for (const size_t i : thinned(line)) {
      if (!std::isfinite(line.y[i])) continue;
      d += "M" + number(x(line.x[i])) + " " + number(clipped(line.y[i])) + "h0";
    }
    return "<path d=\"" + d + "\" stroke=\"" + line.colour + "\" stroke-width=\"" +
           number(2.0 * line.width) + "\" stroke-linecap=\"round\"/>\n";
  }

  std::string band(const ChartLine& line) const {
    if (line.error.empty()) return "";
    std::string upper, lower;
    for (size_t i = 0; i < line.x.size(); ++i) {
      const std::string at = number(x(line.x[i])) + " ";
      upper += (i == 0 ? "M" : "L") + at + number(clipped(line.y[i] + line.error[i]));
      lower = "L" + at + number(clipped(line.y[i] - line.error[i])) + lower;
    }
    return "<path d=\"" + upper + lower + "Z\" fill=\"" + line.colour + "\" opacity=\"0.2\"/>\n";
  }

  double clipped(double value) const { return std::clamp(y(value), top, bottom_); }

  const LineChart& chart_;
  Range x_, y_;
  double bottom_;
};

std::string svg_begin(double height, const std::string& title) {
  return "<svg viewBox=\"0 0 " + number(page_width) + " " + number(height) +
         "\" role=\"img\" aria-label=\"" + html(title) + "\">\n<title>" + html(title) +
         "</title>\n";
}

}  // namespace

std::string line_chart_svg(const LineChart& chart, const std::string& title) {
  const Drawing drawing(chart);
  std::string svg = svg_begin(drawing.total_height(), title) + drawing.shading() + drawing.axes();
  for (const ChartLine& line : chart.lines) svg += drawing.curve(line);
  return svg + drawing.levels() + "</svg>\n";
}

std::string bar_chart_svg(const std::vector<Bar>& bars, const std::string& x_label,
                          const std::string& title) {
  constexpr double row = 27.0, notes = 275.0;
  // As wide as the longest label needs, which is cut where the bars would have no room.
  constexpr size_t max_letters = 62;
  constexpr double letter = 6.6, min_names = 150.0;
  size_t letters = 0;
  for (const Bar& bar : bars) letters = std::max(letters, std::min(max_letters, bar.label.size()));
  const double names = std::max(min_names, 14.0 + letter * static_cast<double>(letters));
  Range range{0.0, 0.0};
  for (const Bar& bar : bars) widen(range, std::isfinite(bar.value) ? bar.value : 0.0);
  if (range.low == range.high) range.high = 1.0;
  // Room for the numbers at the bars' ends.
  constexpr double number_room = 72.0;
  range = {std::min(0.0, range.low), std::max(0.0, range.high)};
  const double from = names + (range.low < 0.0 ? number_room : 0.0);
  const double to = page_width - notes - number_room;
  const double zero = range.at(0.0, from, to), bottom = row * static_cast<double>(bars.size()) + 4;
  std::string svg = svg_begin(bottom + 26.0, title);
  for (size_t i = 0; i < bars.size(); ++i) {
    const Bar& bar = bars[i];
    const double y = 4.0 + row * static_cast<double>(i), end = range.at(bar.value, from, to);
    const std::string weight = bar.chosen ? " class=\"chosen\"" : "";
    const bool fits = bar.label.size() <= max_letters;
    const std::string label = fits ? bar.label : bar.label.substr(0, max_letters - 1) + "…";
    svg += text_at(names - 10.0, y + 17.0, label, "end", weight);
    svg += "<rect x=\"" + number(std::min(zero, end)) + "\" y=\"" + number(y + 4.0) +
           "\" width=\"" + number(std::abs(end - zero)) + "\" height=\"18\" fill=\"" +
           (bar.chosen ? report_colour::after : "#9aa7b5") + "\"/>\n";
    svg += text_at(bar.value < 0.0 ? end - 5.0 : end + 5.0, y + 17.0, plain_number(bar.value),
                   bar.value < 0.0 ? "end" : "start", weight);
    svg += text_at(page_width - notes + 8.0, y + 17.0, bar.note, "start", " class=\"note\"");
  }
  svg += line_at(zero, 2.0, zero, bottom, "class=\"tick\"");
  return svg + text_at(0.5 * (from + to), bottom + 18.0, x_label, "middle") + "</svg>\n";
}

}  // namespace photorque
