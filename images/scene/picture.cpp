#include "images/scene/picture.h"

#include "core/errors.h"
#include "images/drawing/page_layout.h"
#include "images/writers/metadata.h"

namespace photorque {
namespace {

constexpr double narrowest_scene_page = 400.0;
constexpr double triad_length = 30.0;

void require_consistent(const SceneView& view) {
  const auto fail = [](const std::string& found, const std::string& expected) {
    throw InputError({}, "scene view", found, expected);
  };
  if (view.width < 1 || view.height < 1 || view.oversampling < 1) {
    fail("an empty view", "at least one pixel and one sample per pixel");
  }
  const auto samples =
      static_cast<size_t>(view.sample_columns()) * static_cast<size_t>(view.sample_rows());
  for (const size_t count :
       {view.depth_m.size(), view.part.size(), view.normal_lab.size(), view.cos_view.size(),
        view.irradiance_W_m2.size(), view.ray.empty() ? samples : view.ray.size()}) {
    if (count != samples) fail(std::to_string(count) + " samples", std::to_string(samples));
  }
  for (size_t i = 0; i < samples; ++i) {
    const bool known =
        view.part[i] >= 0 && static_cast<size_t>(view.part[i]) < view.part_colour.size();
    if (std::isfinite(view.depth_m[i]) && !known) {
      fail("part " + std::to_string(view.part[i]), "a part with a colour");
    }
  }
}

// Axes that point away from the viewer are drawn first, so that nearer axes cover them.
void draw_triad(Canvas& canvas, const PagePoint& origin, const std::array<Vec3, 3>& axes_camera) {
  const std::array<Rgb, 3> colours = {rgb_from_hex(0xD55E00), rgb_from_hex(0x009E73),
                                      rgb_from_hex(0x0072B2)};
  const std::array<std::string, 3> names = {"x", "y", "z"};
  std::array<size_t, 3> order = {0, 1, 2};
  std::ranges::sort(order, {}, [&](size_t i) { return axes_camera[i].z(); });
  for (const size_t i : order) {
    const Vec3& axis = axes_camera[i];
    const PagePoint end{origin.x + triad_length * axis.x(), origin.y - triad_length * axis.y()};
    canvas.line(origin, end, {{1.0, 1.0, 1.0}, 4.5, 0.7});
    canvas.line(origin, end, {colours[i], 2.4});
    canvas.disc(end, 2.4, colours[i]);
    // The letter is beside the end; for an axis towards the viewer it is at the upper right.
    const double length = std::hypot(axis.x(), axis.y());
    const double right = length > 0.2 ? axis.x() / length : 0.7;
    const double up = length > 0.2 ? axis.y() / length : 0.7;
    canvas.text(names[i], {end.x + 9.0 * right, end.y - 9.0 * up},
                {.size = 11.0,
                 .colour = colours[i],
                 .bold = true,
                 .align = TextAlign::centre,
                 .level = TextLevel::middle});
  }
}

std::vector<uint32_t> as_argb(const Picture& picture) {
  std::vector<uint32_t> argb;
  for (size_t i = 0; i < picture.rgb.size(); i += 3) {
    argb.push_back(opaque_argb({picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]}));
  }
  return argb;
}

}  // namespace

Picture scene_picture(const SceneView& view, const SceneLabels& labels,
                      const Provenance& provenance) {
  require_consistent(view);
  Extent irradiance_W_m2;
  for (size_t i = 0; i < view.irradiance_W_m2.size(); ++i) {
    if (std::isfinite(view.depth_m[i])) irradiance_W_m2.include(view.irradiance_W_m2[i]);
  }
  const bool shows_receiver = irradiance_W_m2.low <= irradiance_W_m2.high;
  const ColourScale scale = colour_scale({0.0, shows_receiver ? irradiance_W_m2.high : 0.0}, false);
  const double per_point = pixels_per_point(PictureStyle::page);
  PageBox image{page_margin, 0.0, view.width / per_point, view.height / per_point};
  const double bar_height = std::max(80.0, std::min(300.0, image.height - 60.0));
  const ColourBar bar = colour_bar(scale, "W/m²", bar_height);
  const double bar_room = shows_receiver ? 18.0 + bar.width() : 0.0;
  const double page_width =
      std::ceil(std::max(narrowest_scene_page, image.right() + bar_room + page_margin));
  const PageText text = page_text(labels.title, labels.caption, provenance, page_width);
  image.y = std::ceil(text.body_top()) + 2.0;
  const double body_height =
      std::max(image.height, bar_height + colour_bar_unit_height) + image.y - text.body_top();
  Canvas canvas =
      Canvas::of_pixels(page_width, std::ceil(text.page_height(body_height)), per_point);
  canvas.image(image, view.width, view.height, as_argb(shaded(view, scale)));
  if (shows_receiver) {
    const double slack = std::max(0.0, image.height - bar_height - colour_bar_unit_height);
    const double bar_y = std::round(image.y + 0.5 * slack + colour_bar_unit_height);
    draw_colour_bar(canvas, bar, {image.right() + 18.0, bar_y}, bar_height);
  }
  if (labels.body_axes_camera) {
    draw_triad(canvas, {image.x + 48.0, image.bottom() - 48.0}, *labels.body_axes_camera);
  }
  draw_page_text(canvas, text, body_height);
  return canvas.finish_pixels();
}

void write_scene_picture(const std::filesystem::path& path, const Picture& picture,
                         const std::string& title, const Provenance& provenance) {
  write_png(path, picture, picture_metadata(title, provenance));
}

}  // namespace photorque
