// Pages of vectors as an <svg> element of an HTML page, written without cairo: its glyphs become
// outlines with ids, which clash where a page holds several pictures.
#include "core/errors.h"
#include "core/text/format.h"
#include "images/canvas/page.h"

namespace photorque {
namespace {

std::string rounded(double value, int decimals = 1) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, value);
  std::string text = buffer.data();
  if (decimals > 0) {
    while (text.ends_with('0')) text.pop_back();
    if (text.ends_with('.')) text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + value + "\"";
}

std::string attribute(const std::string& name, double value) {
  return attribute(name, rounded(value, 2));
}

std::string hex(const Rgb& colour) {
  const auto [red, green, blue] = rgb_bytes(colour);
  std::array<char, 8> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "#%02x%02x%02x", red, green, blue);
  return buffer.data();
}

std::string filled(const Rgb& colour, double opacity) {
  return attribute("fill", hex(colour)) + (opacity < 1.0 ? attribute("fill-opacity", opacity) : "");
}

std::string stroked(const Stroke& stroke) {
  std::string text = attribute("fill", "none") + attribute("stroke", hex(stroke.colour)) +
                     attribute("stroke-width", stroke.width);
  if (stroke.opacity < 1.0) text += attribute("stroke-opacity", stroke.opacity);
  std::string dashes;
  for (const double length : stroke.dashes) dashes += (dashes.empty() ? "" : " ") + rounded(length);
  return text + (dashes.empty() ? "" : attribute("stroke-dasharray", dashes));
}

std::string box_attributes(const PageBox& box) {
  return attribute("x", box.x) + attribute("y", box.y) + attribute("width", box.width) +
         attribute("height", box.height);
}

// "M1.5 2L3 4": to a tenth of a point.
std::string path_through(std::span<const PagePoint> points) {
  std::string path;
  for (const PagePoint& point : points) {
    path += (path.empty() ? "M" : "L") + rounded(point.x) + " " + rounded(point.y);
  }
  return path;
}

class HtmlPage final : public Canvas::Page {
 public:
  HtmlPage(double width, double height, const std::string& title) {
    const std::string clean = xml_text(title);
    svg_ = "<svg" + attribute("class", "chart") +
           attribute("viewBox", "0 0 " + rounded(width) + " " + rounded(height)) +
           attribute("role", "img") + attribute("aria-label", clean) +
           attribute("font-family", "DejaVu Sans, Verdana, sans-serif") + ">\n<title>" + clean +
           "</title>\n";
  }

  void fill(const PageBox& box, const Rgb& colour, double opacity) override {
    svg_ += "<rect" + box_attributes(box) + filled(colour, opacity) + "/>\n";
  }

  void fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity) override {
    svg_ +=
        "<path" + attribute("d", path_through(polygon) + "Z") + filled(colour, opacity) + "/>\n";
  }

  // Dots as strokes of no length with round ends: a tenth of the bytes of circles.
  void discs(std::span<const PagePoint> centres, double radius, const Rgb& colour) override {
    std::string path;
    for (const PagePoint& centre : centres) {
      path += "M" + rounded(centre.x) + " " + rounded(centre.y) + "h0";
    }
    svg_ += "<path" + attribute("d", path) + attribute("stroke", hex(colour)) +
            attribute("stroke-width", 2.0 * radius) + attribute("stroke-linecap", "round") + "/>\n";
  }

  // Opaque lines of one style that follow each other, such as the pieces of a curve with gaps or a
  // grid, become one element.
  void line(std::span<const PagePoint> points, const Stroke& stroke) override {
    const std::string tail =
        "\"" + stroked(stroke) + attribute("stroke-linejoin", "round") + "/>\n";
    if (stroke.opacity == 1.0 && svg_.ends_with(tail)) {
      svg_.erase(svg_.size() - tail.size());
    } else {
      svg_ += "<path d=\"";
    }
    svg_ += path_through(points) + tail;
  }

  void outline(const PageBox& box, const Stroke& stroke) override {
    svg_ += "<rect" + box_attributes(box) + stroked(stroke) + "/>\n";
  }

  void text(const std::string& clean, const PagePoint& at, const TextStyle& style) override {
    constexpr double capital_height = 0.729;  // of DejaVu Sans, in ems
    const double down = style.level == TextLevel::middle ? 0.5 * capital_height * style.size : 0.0;
    std::string placed = attribute("x", at.x) + attribute("y", at.y + down);
    if (style.turn_rad != 0.0) {
      placed =
          attribute("transform", "translate(" + rounded(at.x) + " " + rounded(at.y) + ") rotate(" +
                                     rounded(-style.turn_rad * 180.0 / std::numbers::pi) + ")");
      if (down != 0.0) placed += attribute("y", down);
    }
    if (style.align != TextAlign::left) {
      placed += attribute("text-anchor", style.align == TextAlign::right ? "end" : "middle");
    }
    svg_ += "<text" + placed + attribute("font-size", style.size) +
            (style.bold ? attribute("font-weight", "bold") : "") + filled(style.colour, 1.0) + ">" +
            xml_text(clean) + "</text>\n";
  }

  // Its pixels stay sharp however large they are drawn.
  void image(const PageBox& box, int width, int height, std::span<const uint32_t> argb) override {
    const std::string png = png_of(width, height, argb);
    svg_ += "<image" + box_attributes(box) + attribute("preserveAspectRatio", "none") +
            attribute("style", "image-rendering:pixelated") +
            attribute("href", "data:image/png;base64," + base64(std::as_bytes(std::span(png)))) +
            "/>\n";
  }

  // A picture in the picture cuts off what leaves it, without an id to refer to.
  void begin_clip(const PageBox& box) override {
    svg_ += "<svg" + box_attributes(box) +
            attribute("viewBox", rounded(box.x, 2) + " " + rounded(box.y, 2) + " " +
                                     rounded(box.width, 2) + " " + rounded(box.height, 2)) +
            ">\n";
  }

  void end_clip() override { svg_ += "</svg>\n"; }

  Picture finish_pixels() override {
    throw NumericalError("drawing failed: not a canvas of pixels");
  }

  std::string finish_svg() override { return svg_ + "</svg>\n"; }

 private:
  std::string svg_;
};

}  // namespace

Canvas Canvas::of_html(double width, double height, const std::string& title) {
  return Canvas(std::make_unique<HtmlPage>(width, height, title));
}

}  // namespace photorque
