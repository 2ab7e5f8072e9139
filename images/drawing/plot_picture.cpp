#include "images/drawing/plot_picture.h"

#include "images/drawing/consistency.h"
#include "images/drawing/page_layout.h"
#include "images/drawing/plot_layout.h"

namespace photorque {
namespace {

constexpr double page_width = 640.0;

std::string caption_of(const Plot& plot) {
  const bool any = std::ranges::any_of(panels_of(plot), [](const Plot::Panel& panel) {
    return std::ranges::any_of(panel.curves,
                               [](const Plot::Curve& curve) { return !curve.y_error.empty(); });
  });
  return any ? "Bars and bands: ±1 standard error." : "";
}

// A plot with title, caption and provenance around it.
struct PlotPage {
  PageText text;
  PlotLayout layout;
  double body_height() const { return layout.bottom - text.body_top(); }
  double height() const { return std::ceil(text.page_height(body_height())); }
};

PlotPage page_of(const Plot& plot, const Provenance& provenance) {
  require_consistent(plot);
  PlotPage page;
  page.text = page_text(plot.title, caption_of(plot), provenance, page_width);
  page.layout = plot_layout(plot, {.left = page_margin,
                                   .right = page_width - page_margin,
                                   .top = std::ceil(page.text.body_top())});
  return page;
}

void draw_page(Canvas& canvas, const Plot& plot, const PlotPage& page) {
  draw_plot(canvas, plot, page.layout);
  draw_page_text(canvas, page.text, page.body_height());
}

}  // namespace

Picture plot_picture(const Plot& plot, const Provenance& provenance) {
  const PlotPage page = page_of(plot, provenance);
  Canvas canvas = Canvas::of_pixels(page_width, page.height(), pixels_per_point);
  draw_page(canvas, plot, page);
  return canvas.finish_pixels();
}

std::string plot_svg(const Plot& plot, const Provenance& provenance) {
  const PlotPage page = page_of(plot, provenance);
  Canvas canvas = Canvas::of_vectors(page_width, page.height());
  draw_page(canvas, plot, page);
  return canvas.finish_svg();
}

std::string plot_html(const Plot& plot) {
  require_consistent(plot);
  const PlotLayout layout = plot_layout(plot, {.left = 2.0,
                                               .right = html_chart_width,
                                               .top = 8.0,
                                               .min_axis_width = 64.0,
                                               .resolution = 1.0,
                                               .first_height = 160.0,
                                               .height_below = 105.0});
  Canvas canvas = Canvas::of_html(html_chart_width, std::ceil(layout.bottom + 6.0), plot.title);
  draw_plot(canvas, plot, layout);
  return canvas.finish_svg();
}

}  // namespace photorque
