#include "receivers/gather/plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "receivers/surface_grid.h"

namespace photorque {
namespace {

struct CellPiece {
  size_t bin;
  SurfacePatch patch;
};

// Calls add(bin, corners) for the convex pieces of a face in the bins; see clip_to_cells().
template <typename Add>
void clip_face(const Scene& scene, const SurfaceGrid& grid, const SurfaceFace& face,
               const Add& add) {
  clip_to_cells(corners_in_bins(grid, scene, face), grid.width, grid.height,
                [&](int column, int row, std::span<const Vec2> polygon) {
                  const size_t bin = grid.bin_at(column, row);
                  if (grid.area_m2[bin] > 0.0) add(bin, polygon);
                });
}

constexpr uint32_t no_instance = ~0u, several_instances = no_instance - 1;

// The instance in each bin.
std::vector<uint32_t> instances_in_bins(const Scene& scene, const SurfaceGrid& grid,
                                        std::span<const SurfaceFace> faces) {
  std::vector<uint32_t> instances(grid.bins(), no_instance);
  for (const SurfaceFace& face : faces) {
    clip_face(scene, grid, face, [&](size_t bin, std::span<const Vec2>) {
      uint32_t& here = instances[bin];
      const bool only = here == no_instance || here == face.instance;
      here = only ? face.instance : several_instances;
    });
  }
  return instances;
}

// Adds the pieces of a face in the bins that are `wanted`, as fans of triangles.
void add_pieces(const Scene& scene, const SurfaceGrid& grid, const SurfaceFace& face,
                const std::vector<bool>& wanted, std::vector<CellPiece>& pieces) {
  // Not a structured binding: Clang 14 cannot capture one.
  const Vec3 &a = face.corner_body_m[0], &b = face.corner_body_m[1], &c = face.corner_body_m[2];
  const auto place = [&](const Vec2& weight) {
    return Vec3(a + weight.x() * (b - a) + weight.y() * (c - a));
  };
  clip_face(scene, grid, face, [&](size_t bin, std::span<const Vec2> polygon) {
    if (!wanted[bin]) return;
    const Vec3 origin = place(polygon[0]);
    for (size_t i = 2; i < polygon.size(); ++i) {
      const Vec3 edge1 = place(polygon[i - 1]) - origin, edge2 = place(polygon[i]) - origin;
      const double area_m2 = 0.5 * edge1.cross(edge2).norm();
      if (area_m2 > 1e-12 * grid.area_m2[bin]) {
        pieces.push_back({bin, {origin, edge1, edge2, area_m2, face.instance, true}});
      }
    }
  });
}

// If the only instance of the bin fills it exactly once, sets `whole` to one parallelogram. Returns
// whether it does.
bool fill_whole(const SurfaceGrid& grid, const BinPatches& plane, size_t bin, uint32_t instance,
                SurfacePatch& whole) {
  if (instance >= several_instances) return false;
  const double du = (grid.u_high - grid.u_low) / grid.width;
  const double dv = (grid.v_high - grid.v_low) / grid.height;
  // The plane of the faces may be inclined to the plane of the grid.
  const double lean = plane.normal.dot(grid.normal_body);
  const auto along = [&](const Vec3& axis) {
    return Vec3(axis - plane.normal.dot(axis) / lean * grid.normal_body);
  };
  const double full_m2 = du * dv / std::abs(lean);
  if (std::abs(grid.area_m2[bin] - full_m2) > 1e-9 * full_m2) return false;
  const auto width = static_cast<size_t>(grid.width);
  const size_t column = bin % width, row = bin / width;
  const double u = grid.u_low + du * static_cast<double>(column);
  const double v = grid.v_low + dv * static_cast<double>(row);
  const Vec3 flat = u * grid.u_axis_body + v * grid.v_axis_body;
  const double ray_offset = plane.normal.dot(plane.point_m - flat) / lean;
  whole = {flat + ray_offset * grid.normal_body,
           du * along(grid.u_axis_body),
           dv * along(grid.v_axis_body),
           full_m2,
           instance,
           false};
  return true;
}

}  // namespace

bool is_flat(const Scene& scene, const SurfaceGrid& grid) {
  if (grid.over != SurfaceGrid::Over::plane) return false;
  const std::vector<SurfaceFace> faces = faces_of(scene, grid.instances, grid.facing_body);
  const Vec3 normal = faces[0].area_body_m2.normalized();
  const double extent = std::hypot(grid.u_high - grid.u_low, grid.v_high - grid.v_low);
  return std::all_of(faces.begin(), faces.end(), [&](const SurfaceFace& face) {
    if (face.area_body_m2.dot(normal) < 0.0) return false;
    return std::all_of(face.corner_body_m.begin(), face.corner_body_m.end(), [&](const Vec3& p) {
      return std::abs(normal.dot(p - faces[0].corner_body_m[0])) <= 1e-6 * extent;
    });
  });
}

BinPatches bin_patches(const Scene& scene, const SurfaceGrid& grid) {
  const std::vector<SurfaceFace> faces = faces_of(scene, grid.instances, grid.facing_body);
  BinPatches all;
  all.point_m = faces[0].corner_body_m[0];
  Vec3 area = Vec3::Zero();
  for (const SurfaceFace& face : faces) area += face.area_body_m2;
  all.normal = area.normalized();
  const std::vector<uint32_t> instances = instances_in_bins(scene, grid, faces);
  std::vector<bool> in_part(grid.bins());
  SurfacePatch whole;
  for (size_t bin = 0; bin < grid.bins(); ++bin) {
    in_part[bin] =
        instances[bin] != no_instance && !fill_whole(grid, all, bin, instances[bin], whole);
  }
  std::vector<CellPiece> pieces;
  if (std::find(in_part.begin(), in_part.end(), true) != in_part.end()) {
    for (const SurfaceFace& face : faces) add_pieces(scene, grid, face, in_part, pieces);
  }
  std::ranges::stable_sort(pieces, {}, &CellPiece::bin);
  auto piece = pieces.begin();
  all.patches.reserve(grid.bins());
  for (size_t bin = 0; bin < grid.bins(); ++bin) {
    all.first.push_back(static_cast<uint32_t>(all.patches.size()));
    if (instances[bin] == no_instance) continue;
    if (!in_part[bin]) {
      fill_whole(grid, all, bin, instances[bin], whole);
      all.patches.push_back(whole);
    }
    for (; piece != pieces.end() && piece->bin == bin; ++piece) all.patches.push_back(piece->patch);
  }
  all.first.push_back(static_cast<uint32_t>(all.patches.size()));
  return all;
}

std::array<BinTile, 2> BinTile::halves() const {
  BinTile low = *this, high = *this;
  if (columns >= rows) {
    low.columns = columns / 2;
    high.column += low.columns;
    high.columns -= low.columns;
  } else {
    low.rows = rows / 2;
    high.row += low.rows;
    high.rows -= low.rows;
  }
  return {low, high};
}

std::vector<BinTile> squares_of(const SurfaceGrid& grid) {
  constexpr int most = 32;
  const auto parts = [](int bins) { return (bins + most - 1) / most; };
  const auto begin = [&](int bins, int part) { return bins * part / parts(bins); };
  std::vector<BinTile> squares;
  for (int j = 0; j < parts(grid.height); ++j) {
    for (int i = 0; i < parts(grid.width); ++i) {
      const int column = begin(grid.width, i), row = begin(grid.height, j);
      squares.push_back(
          {column, row, begin(grid.width, i + 1) - column, begin(grid.height, j + 1) - row});
    }
  }
  return squares;
}

GatherPlane::GatherPlane(const TraceableScene& scene, const SurfaceGrid& grid, Side side)
    : scene_(scene), grid_(grid), side_(side), patches_(bin_patches(scene.scene(), grid)) {
  if (side == Side::back) patches_.normal = -patches_.normal;
  const double lean = patches_.normal.dot(grid.normal_body);
  const auto on_plane = [&](double u, double v) {
    const Vec3 flat = u * grid.u_axis_body + v * grid.v_axis_body;
    return Vec3(flat + patches_.normal.dot(patches_.point_m - flat) / lean * grid.normal_body);
  };
  corner_m_ = on_plane(grid.u_low, grid.v_low);
  column_m_ = (on_plane(grid.u_high, grid.v_low) - corner_m_) / grid.width;
  row_m_ = (on_plane(grid.u_low, grid.v_high) - corner_m_) / grid.height;
}

Ball GatherPlane::ball_of(const BinTile& tile) const {
  const Vec3 across = tile.columns * column_m_, along = tile.rows * row_m_;
  const double radius = 0.5 * std::max((across + along).norm(), (across - along).norm());
  return {point_m(tile.column + 0.5 * tile.columns, tile.row + 0.5 * tile.rows), radius};
}

GatherLamp::GatherLamp(const Beam& beam, std::shared_ptr<const DiscLight> of,
                       const RigidTransform& body_from_lab, const GatherPlane& plane)
    : PlacedLamp(beam, std::move(of), body_from_lab, plane.bands(),
                 scene_diameter_m(plane.scene())),
      normal_emitter_(emitter_from_body().direction(plane.normal())),
      lean_rad_(std::acos(std::clamp(-normal_emitter_.z(), -1.0, 1.0))) {
  // Whether no ray comes from behind, or no part of the aperture is behind.
  const Vec3 way = body_from_emitter().translation_m - plane.patches().point_m;
  const double lowest_m = plane.normal().dot(way) - light().radius_m() * std::sin(lean_rad_);
  lights_front_ = light().lights_front(normal_emitter_) || (!light().parallel() && lowest_m > 0.0);
}

std::pair<double, double> GatherLamp::heights_m(const GatherPlane& plane) const {
  const SurfaceGrid& grid = plane.grid();
  std::pair<double, double> heights = {INFINITY, -INFINITY};
  for (const int column : {0, grid.width}) {
    for (const int row : {0, grid.height}) {
      const double height_m = emitter_from_body().point(plane.point_m(column, row)).z();
      heights = {std::min(heights.first, height_m), std::max(heights.second, height_m)};
    }
  }
  return heights;
}

void GatherLamp::fill_irradiance(const GatherPlane& plane, const BinTile& tile,
                                 std::span<const double> fraction, Eigen::MatrixXd& W_m2) const {
  const auto place = [&](int columns, int rows) {
    return emitter_from_body().point(plane.point_m(tile.column + columns, tile.row + rows));
  };
  const Vec3 corner = place(0, 0);
  const Vec3 across = place(tile.columns, 0) - corner, along = place(0, tile.rows) - corner;
  for (size_t j = 0; j < fraction.size(); ++j) {
    const Vec3 start = corner + fraction[j] * along;
    for (size_t i = 0; i < fraction.size(); ++i) {
      W_m2(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          irradiance_at_W_m2(start + fraction[i] * across);
    }
  }
}

ArrivingLight GatherLamp::arriving(const Vec3& at_body_m) const {
  ArrivingLight here = light().arriving(emitter_from_body().point(at_body_m), normal_emitter_);
  here.momentum_W_m2 = body_from_emitter().direction(here.momentum_W_m2);
  return here;
}

std::vector<double> GatherLamp::kinks_along(const Vec3& from_m, const Vec3& to_m) const {
  std::vector<double> ends;
  if (!light().parallel()) {
    ends = light().kinks_along(emitter_from_body().point(from_m), emitter_from_body().point(to_m));
  }
  ends.push_back(1.0);
  return ends;
}

std::vector<double> GatherLamp::kinks_across(const SurfacePatch& patch) const {
  if (light().parallel()) return {1.0};
  const Vec3 corner = emitter_from_body().point(patch.origin_m);
  const Vec3 along = emitter_from_body().direction(patch.edge1_m);
  const Vec3 across = emitter_from_body().direction(patch.edge2_m);
  // The lines end on two sides of the patch, where kinks enter or leave.
  const Vec3 far = corner + along, far_end = patch.triangle ? corner + across : far + across;
  std::vector<double> cuts = light().tangent_lines(corner, along, across);
  for (const auto& side : {light().kinks_along(corner, corner + across),
                           light().kinks_along(far, far_end), std::vector{1.0}}) {
    cuts.insert(cuts.end(), side.begin(), side.end());
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

bool GatherLamp::misses(const Ball& ball) const {
  return lean_rad_ - light().reach_rad() >= 0.5 * pi || PlacedLamp::misses(ball);
}

Integral<double> GatherLamp::power_W(std::span<const Vec3> corners_m, double tolerance_W) const {
  std::array<Vec3, 4> placed;
  for (size_t i = 0; i < corners_m.size(); ++i) placed[i] = emitter_from_body().point(corners_m[i]);
  return light().power_through_W(std::span(placed).first(corners_m.size()), tolerance_W);
}

}  // namespace photorque
