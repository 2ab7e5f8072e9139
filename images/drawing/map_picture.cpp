#include "images/drawing/map.h"

#include "core/errors.h"
#include "core/text/format.h"
#include "images/drawing/plot.h"

namespace photorque {
namespace {

constexpr double max_side = 440.0;
constexpr double tallest = 400.0;
constexpr double largest_ratio = 8.0;
constexpr double shortest_colour_bar = 150.0;
constexpr double narrowest_page = 400.0;

struct MapLayout {
  bool is_page = true;  // otherwise a chart in HTML, without text and numbers on the grid
  PageBox grid;         // in whole points on a page, so that cells match pixels exactly
  Axis x, y;
  ColourBar bar;
  double bar_height = 0.0;
  double bar_x = 0.0;
  double bar_y = 0.0;
  PageText text;
  double body_height = 0.0;
  double width = 0.0;
};

// Colour of letters on this ground.
Rgb ink_on(const Rgb& ground) {
  return lab_from_rgb(ground).lightness > 55.0 ? ink : Rgb{1.0, 1.0, 1.0};
}

PageBox grid_size(const Map& map, double scale = 1.0) {
  double ratio = 4.0 / 3.0;
  if (map.equal_scale) {
    ratio = std::abs((map.x_high - map.x_low) / (map.y_high - map.y_low));
    ratio = std::isfinite(ratio) ? std::clamp(ratio, 1.0 / largest_ratio, largest_ratio) : 1.0;
  }
  const double width = scale * std::min(max_side, tallest * ratio);
  return {0.0, 0.0, std::round(width), std::round(width / ratio)};
}

// Whether the bins are numbered cells, few enough to show their values.
bool are_cells(const Map& map) {
  constexpr int most_a_side = 16;
  return map.x_label.starts_with("cell ") && map.x_low == 0.0 && map.x_high == map.width &&
         map.y_low == 0.0 && map.y_high == map.height && map.width <= most_a_side &&
         map.height <= most_a_side;
}

// Numbers of the cells from 0, at their centres.
Ticks cell_ticks(int cells) {
  Ticks ticks;
  for (int i = 0; i < cells; ++i) {
    ticks.values.push_back(i + 0.5);
    ticks.labels.push_back(std::to_string(i));
  }
  return ticks;
}

MapLayout map_layout(const Map& map, const Provenance& provenance, PictureStyle style) {
  MapLayout layout;
  layout.grid = grid_size(map, page_scale(style));
  // A smooth map is drawn between its nodes, which are at the centres of bins.
  const double half_x = map.smooth ? 0.5 * (map.x_high - map.x_low) / map.width : 0.0;
  const double half_y = map.smooth ? 0.5 * (map.y_high - map.y_low) / map.height : 0.0;
  layout.x = horizontal_axis({map.x_low + half_x, map.x_high - half_x}, false, map.x_label,
                             layout.grid.width);
  layout.y = vertical_axis({map.y_low + half_y, map.y_high - half_y}, false, map.y_label,
                           layout.grid.height);
  if (are_cells(map)) {
    layout.x.ticks = cell_ticks(map.width);
    layout.y.ticks = cell_ticks(map.height);
  }
  layout.bar_height = std::max(layout.grid.height, page_scale(style) * shortest_colour_bar);
  layout.bar = colour_bar(colour_scale(map), map.unit, layout.bar_height);
  layout.grid.x = std::ceil(page_margin + vertical_axis_width(layout.y));
  layout.bar_x = layout.grid.right() + 20.0;
  layout.width = std::ceil(std::max(style == PictureStyle::page ? narrowest_page : 0.0,
                                    layout.bar_x + layout.bar.width() + page_margin));
  layout.text = page_text(map.title, map_caption(map), provenance, layout.width, style);
  layout.bar_y = std::ceil(layout.text.body_top() + colour_bar_unit_height);
  layout.grid.y = layout.bar_y + std::floor(0.5 * (layout.bar_height - layout.grid.height));
  const double grid_bottom = layout.grid.bottom() + horizontal_axis_height(layout.x);
  layout.body_height =
      std::max(grid_bottom, layout.bar_y + layout.bar_height + 6.0) - layout.text.body_top();
  return layout;
}

// Draws the value of every cell in it, dark on light or light on dark.
void draw_cell_numbers(Canvas& canvas, const Map& map, const ColourScale& scale,
                       const PageBox& grid) {
  const double width = grid.width / map.width, height = grid.height / map.height;
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const double value = map.value[static_cast<size_t>(row) * map.width + column];
      if (!std::isfinite(value)) continue;
      TextStyle style{.size = std::clamp(0.2 * std::min(width, height), 6.5, 12.0)};
      style.colour = ink_on(scale(value));
      style.align = TextAlign::centre;
      style.level = TextLevel::middle;
      const TextBlock text = fitted_text(readable_number(value, 3), width - 3.0, style, 5.0, 1);
      canvas.text(text.lines.front(),
                  {grid.x + (column + 0.5) * width, grid.bottom() - (row + 0.5) * height},
                  text.style);
    }
  }
}

// Root mean square of the finite values.
double root_mean_square(const std::vector<double>& values) {
  double squares = 0.0;
  size_t count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    squares += value * value;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

// Draws hatching, which is visible where the map has no value.
void draw_hatching(Canvas& canvas, const PageBox& box) {
  canvas.clipped(box, [&] {
    for (double x = box.x - box.height; x < box.right(); x += 6.0) {
      canvas.line({x, box.bottom()}, {x + box.height, box.y}, {{0.75, 0.75, 0.75}, 0.8});
    }
  });
}

void require_count(const Map& map, const std::string& what, size_t found) {
  const size_t bins = static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  if (found == bins) return;
  throw InputError({}, map.name, std::to_string(found) + " " + what,
                   std::to_string(bins) + " of them");
}

}  // namespace

void require_consistent(const Map& map) {
  if (map.width < 1 || map.height < 1) {
    throw InputError({}, map.name, std::to_string(map.width) + " × " + std::to_string(map.height),
                     "a map of at least one bin");
  }
  require_count(map, "values", map.value.size());
  if (!map.standard_error.empty()) require_count(map, "standard errors", map.standard_error.size());
  if (!map.weight.empty()) require_count(map, "weights", map.weight.size());
}

namespace {

// Draws numbers on contour lines, on a background of the line's colour.
void draw_contour_labels(Canvas& canvas, const Map& map, const MapLayout& layout, int columns,
                         int rows) {
  constexpr double size = 8.5;
  const double per_point = columns / layout.grid.width;
  TextStyle style{.size = size, .align = TextAlign::centre, .level = TextLevel::middle};
  for (const ContourLabel& label :
       contour_labels(map, layout.bar.scale, columns, rows, 32.0 * per_point)) {
    const PagePoint at{layout.grid.x + label.column / per_point,
                       layout.grid.y + label.row / per_point};
    const double half = 0.5 * text_width(label.text, style) + 1.5, tall = 0.55 * size;
    const double c = std::cos(label.turn_rad), s = std::sin(label.turn_rad);
    const auto corner = [&](double u, double v) {
      return PagePoint{at.x + c * u + s * v, at.y - s * u + c * v};
    };
    const Rgb ground = layout.bar.scale(label.value);
    canvas.fill(std::array{corner(-half, -tall), corner(half, -tall), corner(half, tall),
                           corner(-half, tall)},
                ground);
    style.colour = ink_on(ground);
    style.turn_rad = label.turn_rad;
    canvas.text(label.text, at, style);
  }
}

// Draws the grid as an image, with axes and colour bar.
void draw_map(Canvas& canvas, const Map& map, const MapLayout& layout, double per_point) {
  const auto columns = static_cast<int>(std::lround(per_point * layout.grid.width));
  const auto rows = static_cast<int>(std::lround(per_point * layout.grid.height));
  if (!map.smooth) draw_hatching(canvas, layout.grid);
  canvas.image(layout.grid, columns, rows, map_pixels(map, layout.bar.scale, columns, rows));
  if (layout.is_page) {
    if (map.smooth) draw_contour_labels(canvas, map, layout, columns, rows);
    if (are_cells(map)) draw_cell_numbers(canvas, map, layout.bar.scale, layout.grid);
  }
  // On a page the outline is around the cells, not on them.
  const double apart = layout.is_page ? 0.4 : 0.0;
  canvas.outline({layout.grid.x - apart, layout.grid.y - apart, layout.grid.width + 2.0 * apart,
                  layout.grid.height + 2.0 * apart},
                 {ink, 0.8});
  draw_horizontal_axis(canvas, layout.grid, layout.x);
  draw_vertical_axis(canvas, layout.grid, layout.y, vertical_axis_width(layout.y));
  draw_colour_bar(canvas, layout.bar, {layout.bar_x, layout.bar_y}, layout.bar_height);
  draw_page_text(canvas, layout.text, layout.body_height);
}

}  // namespace

DrawnPage page_of(const Map& map, const Provenance& provenance, PictureStyle style) {
  require_consistent(map);
  const MapLayout layout = map_layout(map, provenance, style);
  return {layout.width, std::ceil(layout.text.page_height(layout.body_height)), style, layout.grid,
          [map, layout](Canvas& canvas, double per_point) {
            draw_map(canvas, map, layout, per_point);
          }};
}

std::string map_html(const Map& map) {
  require_consistent(map);
  constexpr double width = 0.5 * html_chart_width, top = 14.0, gap = 14.0;
  const ColourScale scale = colour_scale(map);
  MapLayout layout;
  layout.is_page = false;
  layout.grid = grid_size(map);
  PageBox& grid = layout.grid;
  // The bar's width does not depend on its height.
  const double bar_width = colour_bar(scale, map.unit, grid.height).width();
  // The width of the tick labels depends on the ticks and vice versa: two iterations suffice.
  for (int round = 0; round < 2; ++round) {
    layout.x = horizontal_axis({map.x_low, map.x_high}, false, map.x_label, grid.width);
    layout.y = vertical_axis({map.y_low, map.y_high}, false, map.y_label, grid.height);
    const double room = width - vertical_axis_width(layout.y) - gap - bar_width - 4.0;
    const double ratio = grid.width / grid.height;
    grid.width = std::min(room, 340.0 * ratio);
    grid.height = grid.width / ratio;
  }
  grid.x = 2.0 + vertical_axis_width(layout.y);
  grid.y = layout.bar_y = top + colour_bar_unit_height;
  layout.bar_x = grid.right() + gap;
  layout.bar_height = std::max(grid.height, 90.0);
  layout.bar = colour_bar(scale, map.unit, layout.bar_height);
  const double bottom =
      std::max(grid.bottom() + horizontal_axis_height(layout.x), grid.y + layout.bar_height + 8.0);
  Canvas canvas = Canvas::of_svg(width, std::ceil(bottom + 4.0));
  draw_map(canvas, map, layout, pixels_per_point(PictureStyle::page));
  return canvas.finish_html(map.title);
}

std::string map_caption(const Map& map) {
  Extent extent;
  double sum = 0.0, weights = 0.0;
  size_t count = 0;
  for (size_t bin = 0; bin < map.value.size(); ++bin) {
    const double value = map.value[bin], weight = map.weight.empty() ? 1.0 : map.weight[bin];
    if (!std::isfinite(value)) continue;
    extent.include(value);
    sum += weight * value;
    weights += weight;
    ++count;
  }
  const std::string bins =
      map.smooth ? "interpolated, contour lines at even steps"
                 : std::to_string(map.width) + " × " + std::to_string(map.height) + " bins";
  if (count == 0) return "no values · " + bins;
  // Nodes of a smooth field need not represent equal areas, so that no mean is stated.
  const std::string mean = map.smooth ? "" : "mean " + readable_number(sum / weights) + " · ";
  std::string caption = "min " + readable_number(extent.low) + " · " + mean + "max " +
                        readable_number(extent.high) + (map.unit.empty() ? "" : " " + map.unit) +
                        " · " + bins;
  if (!map.standard_error.empty()) {
    caption +=
        " · standard error " + readable_number(root_mean_square(map.standard_error), 2) + " (rms)";
  }
  for (size_t bin = 0; bin < map.value.size(); ++bin) {
    if (!is_unsure(map, bin)) continue;
    caption += " · grey: within two standard errors of zero";
    break;
  }
  if (map.smooth) return caption;
  return count == map.value.size() ? caption : caption + " · hatched: no value";
}

}  // namespace photorque
