#include "images/scene/picture.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

constexpr Rgb lamp_light = rgb_from_hex(0xFFD75E);
constexpr Rgb lamp_back = rgb_from_hex(0x4A4E55);
constexpr float ray_opacity = 0.42F;
constexpr double room_around = 1.10;

// The projection of a point in front of the camera: its position in samples of the view, and its
// distance along the optical axis.
struct Projected {
  double column, row, along_m;
};

class Screen {
 public:
  Screen(const SceneView& view, const Pinhole& camera)
      : camera_(camera),
        columns_(view.sample_columns()),
        rows_(view.sample_rows()),
        samples_per_slope_(0.5 * columns_ / camera.half_width) {}

  double along_m(const Vec3& at_m) const { return (camera_.position_m - at_m).dot(camera_.back); }
  Projected of(const Vec3& at_m) const {
    const Vec3 from = at_m - camera_.position_m;
    const double along = along_m(at_m);
    return {0.5 * columns_ + samples_per_slope_ * from.dot(camera_.right) / along,
            0.5 * rows_ - samples_per_slope_ * from.dot(camera_.up) / along, along};
  }
  double samples_per_slope() const { return samples_per_slope_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }

 private:
  const Pinhole& camera_;
  int columns_, rows_;
  double samples_per_slope_;
};

void draw_lamp(SceneView& view, const Pinhole& camera, const Screen& screen, const DrawnLamp& lamp,
               int32_t light_part) {
  const double nearest_m = 1e-3 * lamp.radius_m;
  if (screen.along_m(lamp.position_m) < lamp.radius_m + nearest_m) return;
  const Projected middle = screen.of(lamp.position_m);
  const double reach =
      screen.samples_per_slope() * lamp.radius_m / (middle.along_m - lamp.radius_m) * 1.5 + 2.0;
  const auto first = [](double at) { return static_cast<int>(std::floor(std::max(at, 0.0))); };
  const auto last = [](double at, int size) {
    return static_cast<int>(std::ceil(std::clamp(at, -1.0, size - 1.0)));
  };
  const bool shines_here = lamp.direction.dot(camera.position_m - lamp.position_m) > 0.0;
  const Vec3 normal = shines_here ? lamp.direction : Vec3(-lamp.direction);
  for (int row = first(middle.row - reach); row <= last(middle.row + reach, screen.rows()); ++row) {
    for (int column = first(middle.column - reach);
         column <= last(middle.column + reach, screen.columns()); ++column) {
      const Vec3 direction = camera.direction(view, column, row);
      const double slope = direction.dot(normal);
      if (slope > -1e-6) continue;
      const double distance_m = (lamp.position_m - camera.position_m).dot(normal) / slope;
      const Vec3 at_m = camera.position_m + distance_m * direction;
      if ((at_m - lamp.position_m).squaredNorm() > lamp.radius_m * lamp.radius_m) continue;
      const size_t sample = static_cast<size_t>(row) * screen.columns() + column;
      if (!(distance_m < view.depth_m[sample])) continue;
      view.depth_m[sample] = static_cast<float>(distance_m);
      view.part[sample] = shines_here ? light_part : light_part + 1;
      view.normal_lab[sample] = normal.cast<float>();
      view.cos_view[sample] = static_cast<float>(-slope);
      view.irradiance_W_m2[sample] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

void draw_ray(SceneView& view, const Screen& screen, const Vec3& from_m, const Vec3& to_m) {
  // Clips the ray to the part in front of the camera.
  const double nearest_m = 1e-3 * (to_m - from_m).norm();
  double begin = 0.0, end = 1.0;
  const double from_along = screen.along_m(from_m), to_along = screen.along_m(to_m);
  if (std::max(from_along, to_along) <= nearest_m) return;
  const double crossing = (nearest_m - from_along) / (to_along - from_along);
  if (from_along < nearest_m) begin = crossing;
  if (to_along < nearest_m) end = crossing;
  const Projected a = screen.of(from_m + begin * (to_m - from_m));
  const Projected b = screen.of(from_m + end * (to_m - from_m));
  const bool steep = std::abs(b.row - a.row) > std::abs(b.column - a.column);
  const auto along_axis = [&](const Projected& p) { return steep ? p.row : p.column; };
  const auto across_axis = [&](const Projected& p) { return steep ? p.column : p.row; };
  const int size = steep ? screen.rows() : screen.columns();
  const int breadth = steep ? screen.columns() : screen.rows();
  const double span = along_axis(b) - along_axis(a);
  const int low = static_cast<int>(
      std::clamp(std::ceil(std::min(along_axis(a), along_axis(b)) - 0.5), 0.0, size - 0.0));
  const int high = static_cast<int>(
      std::clamp(std::floor(std::max(along_axis(a), along_axis(b)) - 0.5), -1.0, size - 1.0));
  const int half = view.oversampling / 2;
  for (int step = low; step <= high; ++step) {
    const double t = span == 0.0 ? 0.0 : (step + 0.5 - along_axis(a)) / span;
    // In a perspective view the inverse of the distance is linear along a line of the picture.
    const double along_m = 1.0 / ((1.0 - t) / a.along_m + t / b.along_m);
    const double middle = std::floor(across_axis(a) + t * (across_axis(b) - across_axis(a)));
    if (!(middle >= -half && middle < breadth + half)) continue;
    for (int shift = -half; shift <= half; ++shift) {
      const int across = static_cast<int>(middle) + shift;
      if (across < 0 || across >= breadth) continue;
      const int column = steep ? across : step, row = steep ? step : across;
      const size_t sample = static_cast<size_t>(row) * screen.columns() + column;
      const double x = (column + 0.5 - 0.5 * screen.columns()) / screen.samples_per_slope();
      const double y = (row + 0.5 - 0.5 * screen.rows()) / screen.samples_per_slope();
      // A tolerance, because a ray ends on the surface that it meets and must not be hidden by it.
      const double distance_m = along_m * std::sqrt(1.0 + x * x + y * y);
      if (0.999 * distance_m > view.depth_m[sample]) continue;
      view.ray[sample] = 1.0F - (1.0F - view.ray[sample]) * (1.0F - ray_opacity);
    }
  }
}

}  // namespace

Pinhole Pinhole::looking(const Vec3& position_m, const Vec3& target_m, double field_of_view_rad) {
  Pinhole camera;
  camera.position_m = position_m;
  camera.back = (position_m - target_m).normalized();
  Vec3 side = Vec3::UnitZ().cross(camera.back);
  if (side.norm() < 1e-9) side = Vec3::UnitX();
  camera.right = side.normalized();
  camera.up = camera.back.cross(camera.right);
  camera.half_width = std::tan(0.5 * field_of_view_rad);
  return camera;
}

Vec3 Pinhole::direction(const SceneView& view, int column, int row) const {
  const int columns = view.sample_columns(), rows = view.sample_rows();
  const double x = (column + 0.5) / columns * 2 - 1;
  const double y = (1 - (row + 0.5) / rows * 2) * rows / columns;
  return (half_width * (x * right + y * up) - back).normalized();
}

Pinhole framing(const Pinhole& camera, std::span<const Vec3> points_m, double height_over_width) {
  Eigen::AlignedBox2d box;
  for (const Vec3& at : points_m) box.extend(Vec2(at.dot(camera.right), at.dot(camera.up)));
  if (box.isEmpty()) return camera;
  const Vec2 middle = box.center();
  double back_m = -std::numeric_limits<double>::infinity();  // along `back`
  for (const Vec3& at : points_m) {
    const double across = std::abs(at.dot(camera.right) - middle.x()) / camera.half_width;
    const double upward =
        std::abs(at.dot(camera.up) - middle.y()) / (camera.half_width * height_over_width);
    back_m = std::max(back_m, at.dot(camera.back) + room_around * std::max(across, upward));
  }
  Pinhole moved = camera;
  moved.position_m = middle.x() * camera.right + middle.y() * camera.up + back_m * camera.back;
  return moved;
}

void draw_lamps(SceneView& view, const Pinhole& camera, const std::vector<DrawnLamp>& lamps) {
  const auto light_part = static_cast<int32_t>(view.part_colour.size());
  view.part_colour.push_back(lamp_light);
  view.part_colour.push_back(lamp_back);
  const Screen screen(view, camera);
  for (const DrawnLamp& lamp : lamps) draw_lamp(view, camera, screen, lamp, light_part);
}

void draw_rays(SceneView& view, const Pinhole& camera, const std::vector<float>& rays_m) {
  view.ray.resize(view.depth_m.size(), 0.0F);
  const Screen screen(view, camera);
  for (size_t i = 0; i + 6 <= rays_m.size(); i += 6) {
    const auto at = [&](size_t k) { return Vec3(rays_m[k], rays_m[k + 1], rays_m[k + 2]); };
    draw_ray(view, screen, at(i), at(i + 3));
  }
}

}  // namespace photorque
