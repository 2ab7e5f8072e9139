#include "receivers/surface_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ranges>

#include "core/numerics/divide_convex.h"

namespace photorque {
namespace {

InputError error(const SurfaceGridOptions& options, const std::string& found,
                 const std::string& expected) {
  return InputError(options.where, options.key, found, expected);
}

double area_of(std::span<const SurfaceFace> faces) {
  return std::accumulate(faces.begin(), faces.end(), 0.0, [](double sum, const SurfaceFace& face) {
    return sum + face.area_body_m2.norm();
  });
}

Vec3 normal_of(std::span<const SurfaceFace> faces, const SurfaceGridOptions& options) {
  if (options.facing_body) return options.facing_body->normalized();
  Vec3 sum = Vec3::Zero();
  for (const SurfaceFace& face : faces) sum += face.area_body_m2;
  if (sum.norm() < 1e-6 * area_of(faces)) {
    throw error(options, "a closed surface with a mean normal of zero",
                "an open surface, or the direction to look from: facing = [x, y, z], or over = "
                "\"uv\"");
  }
  return sum.normalized();
}

void set_axes(SurfaceGrid& grid, const Vec3& normal_body) {
  const auto in_plane = [&](const Vec3& axis) {
    return Vec3(axis - axis.dot(normal_body) * normal_body);
  };
  const bool along_x = in_plane(Vec3::UnitX()).norm() < 1e-6;
  grid.normal_body = normal_body;
  grid.u_axis_body = in_plane(along_x ? Vec3::UnitY() : Vec3::UnitX()).normalized();
  grid.v_axis_body = normal_body.cross(grid.u_axis_body);
}

Vec2 plane_coordinates(const SurfaceGrid& grid, const Vec3& position_body_m) {
  return {grid.u_axis_body.dot(position_body_m), grid.v_axis_body.dot(position_body_m)};
}

void fit_extent(SurfaceGrid& grid, std::span<const SurfaceFace> faces,
                const SurfaceGridOptions& options) {
  Eigen::AlignedBox2d bounds;
  for (const SurfaceFace& face : faces) {
    for (const Vec3& corner : face.corner_body_m) bounds.extend(plane_coordinates(grid, corner));
  }
  if ((bounds.sizes().array() <= 0.0).any()) {
    throw error(options, "a surface that is edge-on to the grid", "a surface seen from its front");
  }
  grid.u_low = bounds.min().x();
  grid.v_low = bounds.min().y();
  grid.u_high = bounds.max().x();
  grid.v_high = bounds.max().y();
}

void check_texture(const Scene& scene, std::span<const SurfaceFace> faces,
                   const SurfaceGridOptions& options) {
  constexpr double slack = 1e-6;  // texture coordinates are often stored as rounded integers
  for (const SurfaceFace& face : faces) {
    const Instance& instance = scene.instances[face.instance];
    if (scene.meshes[instance.mesh].uv.empty()) {
      throw error(options, "node \"" + instance.node + "\" without texture coordinates",
                  "a mesh with texture coordinates, or over = \"plane\"");
    }
    for (const Vec2& uv : texture_corners(scene, face)) {
      if (!((uv.array() >= -slack).all() && (uv.array() <= 1 + slack).all())) {
        throw error(options,
                    "texture coordinates (" + std::to_string(uv.x()) + ", " +
                        std::to_string(uv.y()) + ") on node \"" + instance.node + "\"",
                    "texture coordinates from 0 to 1");
      }
    }
  }
}

Vec2 to_cells(const SurfaceGrid& grid, const Vec2& uv) {
  return {(uv.x() - grid.u_low) / (grid.u_high - grid.u_low) * grid.width,
          (uv.y() - grid.v_low) / (grid.v_high - grid.v_low) * grid.height};
}

void measure_areas(SurfaceGrid& grid, const Scene& scene, std::span<const SurfaceFace> faces) {
  grid.area_m2.assign(static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height), 0.0);
  std::vector<double> seen_m2 = grid.area_m2;  // projected along the normal
  for (const SurfaceFace& face : faces) {
    const double area_m2 = face.area_body_m2.norm();
    const double face_seen_m2 = std::abs(face.area_body_m2.dot(grid.normal_body));
    split_over_cells(corners_in_bins(grid, scene, face), grid.width, grid.height,
                     [&](int column, int row, double fraction) {
                       const size_t bin = grid.bin_at(column, row);
                       grid.area_m2[bin] += fraction * area_m2;
                       seen_m2[bin] += fraction * face_seen_m2;
                     });
  }
  if (grid.over == SurfaceGrid::Over::plane) {
    const double bin_m2 =
        (grid.u_high - grid.u_low) * (grid.v_high - grid.v_low) / static_cast<double>(grid.bins());
    for (const double seen : seen_m2) grid.overlapping_m2 += std::max(0.0, seen - bin_m2);
  }
  // If an edge of the surface is on a line of the grid, rounding puts a sliver into the next bin.
  // Such slivers are removed.
  const double largest_m2 = *std::max_element(grid.area_m2.begin(), grid.area_m2.end());
  for (double& area_m2 : grid.area_m2) {
    if (area_m2 < 1e-11 * largest_m2) area_m2 = 0.0;
  }
}

size_t nearest_bin(const SurfaceGrid& grid, const Vec2& uv) {
  const Vec2 cell = to_cells(grid, uv);
  return grid.bin_at(static_cast<int>(std::clamp(cell.x(), 0.0, grid.width - 1.0)),
                     static_cast<int>(std::clamp(cell.y(), 0.0, grid.height - 1.0)));
}

}  // namespace

std::vector<SurfaceFace> faces_of(const Scene& scene, std::span<const uint32_t> instances,
                                  const std::optional<Vec3>& facing_body) {
  std::vector<SurfaceFace> faces;
  for (const uint32_t index : instances) {
    const Instance& instance = scene.instances[index];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const bool mirrored = instance.body_from_mesh.linear().determinant() < 0.0;
    for (uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      SurfaceFace face{index, triangle, {}, {}};
      for (size_t i = 0; i < 3; ++i) {
        face.corner_body_m[i] =
            instance.body_from_mesh * mesh.vertices_m[mesh.triangles[triangle][i]];
      }
      const auto& [a, b, c] = face.corner_body_m;
      face.area_body_m2 = (mirrored ? -0.5 : 0.5) * (b - a).cross(c - a);
      const bool turned_towards =
          !facing_body || face.area_body_m2.dot(*facing_body) >
                              1e-9 * face.area_body_m2.norm() * facing_body->norm();
      if (turned_towards) faces.push_back(face);
    }
  }
  return faces;
}

double SurfaceGrid::total_area_m2() const {
  return std::accumulate(area_m2.begin(), area_m2.end(), 0.0);
}

SurfaceGrid make_surface_grid(const Scene& scene, std::span<const uint32_t> instances,
                              const SurfaceGridOptions& options) {
  for (const int bins : {options.width, options.height}) {
    if (bins < 1 || bins > max_grid_bins) {
      throw error(options, std::to_string(bins) + " bins",
                  "1 to " + std::to_string(max_grid_bins) + " bins in each direction");
    }
  }
  const std::vector<SurfaceFace> faces = faces_of(scene, instances, options.facing_body);
  if (!(area_of(faces) > 0.0)) {
    throw error(options, options.facing_body ? "no surface that faces that way" : "zero area",
                "a surface with area");
  }
  SurfaceGrid grid;
  grid.over = options.over;
  grid.side = options.side;
  grid.facing_body = options.facing_body;
  grid.instances.assign(instances.begin(), instances.end());
  grid.width = options.width;
  grid.height = options.height;
  if (grid.over == SurfaceGrid::Over::plane) {
    set_axes(grid, normal_of(faces, options));
    fit_extent(grid, faces, options);
  } else {
    check_texture(scene, faces, options);
  }
  measure_areas(grid, scene, faces);
  return grid;
}

size_t bin_of_position(const SurfaceGrid& grid, const Vec3& position_body_m) {
  return nearest_bin(grid, plane_coordinates(grid, position_body_m));
}

size_t bin_of_texture(const SurfaceGrid& grid, const Vec2& uv) {
  return nearest_bin(grid, uv);
}

std::array<Vec2, 3> corners_in_bins(const SurfaceGrid& grid, const Scene& scene,
                                    const SurfaceFace& face) {
  std::array<Vec2, 3> corners;
  if (grid.over == SurfaceGrid::Over::texture) corners = texture_corners(scene, face);
  for (size_t i = 0; i < 3; ++i) {
    if (grid.over == SurfaceGrid::Over::plane) {
      corners[i] = plane_coordinates(grid, face.corner_body_m[i]);
    }
    corners[i] = to_cells(grid, corners[i]);
  }
  return corners;
}

std::array<Vec2, 3> texture_corners(const Scene& scene, const SurfaceFace& face) {
  const Mesh& mesh = scene.meshes[scene.instances[face.instance].mesh];
  const auto& corners = mesh.triangles[face.triangle];
  return {mesh.uv[corners[0]], mesh.uv[corners[1]], mesh.uv[corners[2]]};
}

namespace {

// A corner of a clipped piece: its position on the grid (x, y) and in the triangle (z, w).
using Corner = Eigen::Vector4d;

// A triangle cut by four lines has at most seven corners; the others allow for rounding.
struct Piece {
  std::array<Corner, 12> corner;
  size_t count = 0;

  std::span<const Corner> corners() const { return std::span(corner).first(count); }
  void add(const Corner& c) { corner[count++] = c; }
};

// Parts below and above `at` along an axis.
std::array<Piece, 2> cut(const Piece& piece, int axis, double at) {
  std::array<Piece, 2> parts;
  divide_convex(
      piece.corners(), [&](const Corner& corner) { return corner[axis] - at; },
      [&](Corner corner, double side) {
        if (side == 0.0) corner[axis] = at;
        if (side <= 0.0) parts[0].add(corner);
        if (side >= 0.0) parts[1].add(corner);
      });
  return parts;
}

// Area of a piece as a fraction of its triangle, whose barycentric coordinates enclose an area of
// one half.
double area_fraction(std::span<const Vec2> piece) {
  double twice_area = 0.0;
  for (size_t i = 2; i < piece.size(); ++i) {
    const Vec2 a = piece[i - 1] - piece[0];
    const Vec2 b = piece[i] - piece[0];
    twice_area += a.x() * b.y() - a.y() * b.x();
  }
  return std::max(0.0, twice_area);
}

// Calls take(index, part) for the parts of a piece between consecutive integers along an axis.
template <typename Take>
void slice(Piece rest, int axis, int size, const Take& take) {
  const auto [low, high] = std::ranges::minmax(
      rest.corners() | std::views::transform([axis](const Corner& c) { return c[axis]; }));
  const auto index = [size](double x) {
    return static_cast<int>(std::clamp(std::floor(x), 0.0, size - 1.0));
  };
  // A piece that is edge-on to this axis is not cut: the side of a line to which its corners round
  // is arbitrary.
  const int first = index(low);
  const int last = high - low < 1e-9 ? first : index(high);
  for (int i = first; i < last; ++i) {
    const auto [below, above] = cut(rest, axis, i + 1.0);
    if (below.count >= 3) take(i, below);
    rest = above;
  }
  if (rest.count >= 3) take(last, rest);
}

}  // namespace

void clip_to_cells(const std::array<Vec2, 3>& corners, int width, int height,
                   const std::function<void(int, int, std::span<const Vec2>)>& add) {
  Piece triangle;
  triangle.add({corners[0].x(), corners[0].y(), 0.0, 0.0});
  triangle.add({corners[1].x(), corners[1].y(), 1.0, 0.0});
  triangle.add({corners[2].x(), corners[2].y(), 0.0, 1.0});
  slice(triangle, 0, width, [&](int column, const Piece& strip) {
    slice(strip, 1, height, [&](int row, const Piece& part) {
      std::array<Vec2, 12> weights;
      for (size_t i = 0; i < part.count; ++i) weights[i] = part.corner[i].tail<2>();
      add(column, row, std::span(weights).first(part.count));
    });
  });
}

void split_over_cells(const std::array<Vec2, 3>& corners, int width, int height,
                      const std::function<void(int, int, double)>& add) {
  clip_to_cells(corners, width, height, [&](int column, int row, std::span<const Vec2> piece) {
    add(column, row, area_fraction(piece));
  });
}

namespace {

std::string plane_label(const Vec3& axis_body, const std::string& otherwise) {
  const char* names[] = {"x [m]", "y [m]", "z [m]"};
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis_body[i] - 1.0) < 1e-9) return names[i];
    if (std::abs(axis_body[i] + 1.0) < 1e-9) return std::string("−") + names[i];
  }
  return otherwise;
}

}  // namespace

Map grid_map(const SurfaceGrid& grid, const std::vector<Estimate>& bins, const std::string& name,
             const std::string& title, const std::string& unit) {
  Map map{name,       title,       unit,       grid.width, grid.height,
          grid.u_low, grid.u_high, grid.v_low, grid.v_high};
  const bool plane = grid.over == SurfaceGrid::Over::plane;
  map.x_label = plane ? plane_label(grid.u_axis_body, "u [m]") : "texture u";
  map.y_label = plane ? plane_label(grid.v_axis_body, "v [m]") : "texture v";
  for (const Estimate& bin : bins) {
    map.value.push_back(bin.value);
    map.standard_error.push_back(bin.standard_error);
  }
  return map;
}

}  // namespace photorque
