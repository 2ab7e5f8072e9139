// Charts of the report as inline SVG.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace photorque {

// Colours that colour-blind readers tell apart: M. Okabe and K. Ito, "Color Universal Design"
// (2008).
namespace report_colour {
inline constexpr const char* measured = "#5c5c5c";
inline constexpr const char* before = "#d55e00";  // vermilion
inline constexpr const char* after = "#0072b2";   // blue
inline constexpr const char* good = "#00795c";
inline constexpr const char* shade = "#e6edf5";
inline constexpr const char* text = "#1b1f24";
inline constexpr const char* faint = "#d5d9de";
}  // namespace report_colour

struct ChartLine {
  std::string colour = {};
  std::vector<double> x = {}, y = {};  // gaps where not finite
  bool dots = false;
  bool dashed = false;
  double width = 1.4;
  std::vector<double> error = {};  // a band of ± this
};

// One pair of axes.
struct LineChart {
  std::string y_label = {}, x_label = {};
  double height = 170.0;
  bool with_x_axis = true;
  std::vector<ChartLine> lines = {};                   // later ones on top
  std::vector<std::pair<double, double>> shaded = {};  // intervals of x
  std::string shade_label = {};
  std::vector<double> levels = {};  // dashed horizontal lines
  // Fits y to the central part of the values, so that one outlier does not flatten the rest.
  bool robust_range = false;
};

// Lines of one width; every chart has the page's full width.
std::string line_chart_svg(const LineChart& chart, const std::string& title);

struct Bar {
  std::string label = {};  // left of the bar
  double value = 0.0;
  std::string note = {};  // right of it
  bool chosen = false;
};
// Horizontal bars from zero, each with its number; negative ones to the left.
std::string bar_chart_svg(const std::vector<Bar>& bars, const std::string& x_label,
                          const std::string& title);

}  // namespace photorque
