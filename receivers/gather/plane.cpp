#include "receivers/gather/plane.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"

namespace photorque {

std::pair<BinTile, BinTile> BinTile::halves() const {
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

GatherPlane::GatherPlane(const TraceableScene& scene, const SurfaceGrid& grid, const Bands& bands,
                         Side side)
    : scene_(scene),
      grid_(grid),
      bands_(bands),
      side_(side),
      patches_(bin_patches(scene.scene(), grid)) {
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
  // Either no ray comes from behind, or nothing of the aperture is behind.
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
  // Lines end on two sides of the patch, where a kink comes in or goes out.
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
