#include "images/scene/picture.h"

namespace photorque {
namespace {

constexpr float outline_strength = 1.0F;
constexpr float border_strength = 0.7F;
constexpr float crease_strength = 0.5F;
constexpr double edge_darkening = 0.62;
constexpr Rgb edge_colour = {0.12, 0.12, 0.14};
// As a fraction of the range of depths in view. A larger second difference is a jump, a smaller one
// may be a curved surface.
constexpr float depth_step = 0.01F;

bool hit(const SceneView& view, size_t sample) {
  return std::isfinite(view.depth_m[sample]);
}

// Strength of an edge between two neighbouring samples, of which at most one hits nothing.
float pair_strength(const SceneView& view, size_t a, size_t b) {
  const float crease_cosine = std::cos(25.0F * 0.01745329F);
  if (hit(view, a) != hit(view, b)) return outline_strength;
  if (!hit(view, a)) return 0.0F;
  if (view.part[a] != view.part[b]) return border_strength;
  return view.normal_lab[a].dot(view.normal_lab[b]) < crease_cosine ? crease_strength : 0.0F;
}

// Largest second differences of depth and of inverse depth on a surface.
struct StepLimits {
  float depth_m = 1.0F;
  float inverse_depth_1_m = 1.0F;
};

StepLimits step_limits(const SceneView& view) {
  float nearest = std::numeric_limits<float>::infinity();
  float farthest = 0.0F;
  for (const float depth : view.depth_m) {
    if (!std::isfinite(depth)) continue;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  if (!(farthest > nearest)) return {};
  return {depth_step * (farthest - nearest), depth_step * (1.0F / nearest - 1.0F / farthest)};
}

// Whether the depth jumps between three samples in a row. On a plane the depth is linear in a
// parallel view, its inverse in a perspective view; a jump must show in both.
bool depth_jumps(const SceneView& view, size_t before, size_t here, size_t after,
                 const StepLimits& limits) {
  const float a = view.depth_m[before];
  const float b = view.depth_m[here];
  const float c = view.depth_m[after];
  if (!std::isfinite(a) || !std::isfinite(b) || !std::isfinite(c)) return false;
  return std::abs(a - 2.0F * b + c) > limits.depth_m &&
         std::abs(1.0F / a - 2.0F / b + 1.0F / c) > limits.inverse_depth_1_m;
}

struct Grid {
  int columns, rows;
  size_t at(int column, int row) const { return static_cast<size_t>(row) * columns + column; }
};

// Largest value within `radius` along rows or columns.
std::vector<float> widened(const std::vector<float>& values, const Grid& grid, int radius,
                           bool along_rows) {
  std::vector<float> result(values.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      float strongest = 0.0F;
      for (int shift = -radius; shift <= radius; ++shift) {
        const int c = std::clamp(column + (along_rows ? shift : 0), 0, grid.columns - 1);
        const int r = std::clamp(row + (along_rows ? 0 : shift), 0, grid.rows - 1);
        strongest = std::max(strongest, values[grid.at(c, r)]);
      }
      result[grid.at(column, row)] = strongest;
    }
  }
  return result;
}

Eigen::Vector3d as_light(const Rgb& colour) {
  return {linear_from_encoded(colour.red), linear_from_encoded(colour.green),
          linear_from_encoded(colour.blue)};
}

// Headlight and sky: a headlight alone makes level surfaces look flat; the sky shows the upward
// direction.
double brightness(const SceneView& view, size_t sample) {
  const double sky = 0.5 + 0.5 * static_cast<double>(view.normal_lab[sample].z());
  return 0.30 + 0.30 * sky + 0.40 * static_cast<double>(view.cos_view[sample]);
}

Eigen::Vector3d sample_light(const SceneView& view, const ColourScale& scale, size_t sample,
                             float edge) {
  Eigen::Vector3d light = as_light(scene_background);
  if (hit(view, sample)) {
    const double irradiance = view.irradiance_W_m2[sample];
    light =
        std::isnan(irradiance)
            ? Eigen::Vector3d(brightness(view, sample) *
                              as_light(view.part_colour[static_cast<size_t>(view.part[sample])]))
            : as_light(scale(irradiance));
  }
  const double weight = edge_darkening * static_cast<double>(edge);
  light = (1.0 - weight) * light + weight * as_light(edge_colour);
  const double ray = view.ray.empty() ? 0.0 : view.ray[sample];
  return (1.0 - ray) * light + ray * as_light(ray_colour);
}

}  // namespace

std::vector<float> edge_strength(const SceneView& view) {
  const Grid grid{view.sample_columns(), view.sample_rows()};
  std::vector<float> strength(view.depth_m.size(), 0.0F);
  const StepLimits limits = step_limits(view);
  const auto mark = [&](int column, int row, int across, int down) {
    if (column + across >= grid.columns || row + down >= grid.rows) return;
    const size_t here = grid.at(column, row);
    const size_t after = grid.at(column + across, row + down);
    float edge = pair_strength(view, here, after);
    if (column >= across && row >= down) {
      const size_t before = grid.at(column - across, row - down);
      if (depth_jumps(view, before, here, after, limits)) edge = std::max(edge, border_strength);
    }
    // The nearer sample carries the line, so that outlines are on the object.
    const size_t nearer = view.depth_m[after] < view.depth_m[here] ? after : here;
    strength[nearer] = std::max(strength[nearer], edge);
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      mark(column, row, 1, 0);
      mark(column, row, 0, 1);
    }
  }
  const int radius = view.oversampling / 2;
  return widened(widened(strength, grid, radius, true), grid, radius, false);
}

Picture shaded(const SceneView& view, const ColourScale& scale) {
  const std::vector<float> edges = edge_strength(view);
  const Grid grid{view.sample_columns(), view.sample_rows()};
  const double weight = 1.0 / (view.oversampling * view.oversampling);
  Picture picture{view.width, view.height, {}};
  picture.rgb.reserve(size_t{3} * view.width * view.height);
  for (int row = 0; row < view.height; ++row) {
    for (int column = 0; column < view.width; ++column) {
      Eigen::Vector3d light = Eigen::Vector3d::Zero();
      for (int i = 0; i < view.oversampling * view.oversampling; ++i) {
        const size_t sample = grid.at(column * view.oversampling + i % view.oversampling,
                                      row * view.oversampling + i / view.oversampling);
        light += sample_light(view, scale, sample, edges[sample]);
      }
      light = (weight * light).cwiseMax(0.0).cwiseMin(1.0);
      for (const uint8_t byte :
           rgb_bytes({encoded_from_linear(light.x()), encoded_from_linear(light.y()),
                      encoded_from_linear(light.z())})) {
        picture.rgb.push_back(byte);
      }
    }
  }
  return picture;
}

}  // namespace photorque
