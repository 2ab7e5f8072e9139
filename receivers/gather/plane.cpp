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

GatherLamp::GatherLamp(const Beam& beam, std::shared_ptr<const DiscLight> light,
                       const RigidTransform& body_from_lab, const GatherPlane& plane)
    : light_(std::move(light)),
      body_from_emitter_(body_from_lab * beam.lab_from_emitter),
      emitter_from_body_(body_from_emitter_.inverse()),
      normal_emitter_(emitter_from_body_.direction(plane.normal())),
      fraction_(band_fractions(beam.spectrum, plane.bands())),
      scene_diameter_m_(scene_diameter_m(plane.scene())),
      lean_rad_(std::acos(std::clamp(-normal_emitter_.z(), -1.0, 1.0))),
      reach_slope_(std::tan(std::min(light_->reach_rad(), 1.5))),
      wide_(light_->reach_rad() > 1.5) {
  double total = 0.0;
  for (const double fraction : fraction_) total += fraction;
  for (double& fraction : fraction_) fraction /= total;
  // Either no ray comes from behind, or nothing of the aperture is behind.
  const Vec3 way = body_from_emitter_.translation_m - plane.patches().point_m;
  const double lowest_m = plane.normal().dot(way) - light_->radius_m() * std::sin(lean_rad_);
  lights_front_ = light_->lights_front(normal_emitter_) || (!light_->parallel() && lowest_m > 0.0);
}

std::pair<double, double> GatherLamp::heights_m(const GatherPlane& plane) const {
  const SurfaceGrid& grid = plane.grid();
  std::pair<double, double> heights = {INFINITY, -INFINITY};
  for (const int column : {0, grid.width}) {
    for (const int row : {0, grid.height}) {
      const double height_m = emitter_from_body_.point(plane.point_m(column, row)).z();
      heights = {std::min(heights.first, height_m), std::max(heights.second, height_m)};
    }
  }
  return heights;
}

ArrivingLight GatherLamp::arriving(const Vec3& at_body_m) const {
  ArrivingLight light = light_->arriving(emitter_from_body_.point(at_body_m), normal_emitter_);
  light.momentum_W_m2 = body_from_emitter_.direction(light.momentum_W_m2);
  return light;
}

std::vector<double> GatherLamp::kinks_along(const Vec3& from_m, const Vec3& to_m) const {
  std::vector<double> ends;
  if (!light_->parallel()) {
    ends = light_->kinks_along(emitter_from_body_.point(from_m), emitter_from_body_.point(to_m));
  }
  ends.push_back(1.0);
  return ends;
}

std::vector<double> GatherLamp::kinks_across(const SurfacePatch& patch) const {
  if (light_->parallel()) return {1.0};
  const Vec3 corner = emitter_from_body_.point(patch.origin_m);
  const Vec3 along = emitter_from_body_.direction(patch.edge1_m);
  const Vec3 across = emitter_from_body_.direction(patch.edge2_m);
  // Lines end on two sides of the patch, where a kink comes in or goes out.
  const Vec3 far = corner + along, far_end = patch.triangle ? corner + across : far + across;
  std::vector<double> cuts = light_->tangent_lines(corner, along, across);
  for (const auto& side : {light_->kinks_along(corner, corner + across),
                           light_->kinks_along(far, far_end), std::vector{1.0}}) {
    cuts.insert(cuts.end(), side.begin(), side.end());
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

bool GatherLamp::misses(const Ball& ball) const {
  if (lean_rad_ - light_->reach_rad() >= 0.5 * pi) return true;
  if (light_->parallel()) return false;
  const Vec3 at = emitter_from_body_.point(ball.centre_m);
  if (at.z() + ball.radius_m <= 0.0) return true;
  if (wide_) return false;
  const double reach = light_->radius_m() + (at.z() + ball.radius_m) * reach_slope_;
  return std::hypot(at.x(), at.y()) - ball.radius_m > reach;
}

Ball GatherLamp::aperture_ball(const Ball& ball) const {
  const Vec3 at = emitter_from_body_.point(ball.centre_m);
  if (light_->parallel()) {
    const double far = scene_diameter_m_;
    return {body_from_emitter_.point(at - far * Vec3::UnitZ()), far * reach_slope_ + ball.radius_m};
  }
  const double seen = (std::max(at.z(), 0.0) + ball.radius_m) * reach_slope_ + ball.radius_m;
  if (!wide_ && seen < light_->radius_m()) {
    return {body_from_emitter_.point({at.x(), at.y(), 0.0}), seen};
  }
  return {body_from_emitter_.translation_m, light_->radius_m()};
}

bool GatherLamp::smooth_over(const Ball& ball) const {
  if (light_->parallel()) return true;
  const Vec3 at = emitter_from_body_.point(ball.centre_m);
  if (at.z() < 2.0 * ball.radius_m) return false;
  if (light_->fades_out()) return true;
  // Kinks are where a circle about the axis touches the rim of an edge's light, d = |R ± h tan θ|.
  const double d = at.head<2>().norm(), radius_m = light_->radius_m();
  for (const double slope : light_->angles().edge_slopes()) {
    if (std::isinf(slope)) continue;
    const double foot_m = at.z() * slope, reach_m = ball.radius_m * std::hypot(1.0, slope);
    for (const double kink_m : {radius_m + foot_m, radius_m - foot_m, foot_m - radius_m}) {
      if (std::abs(d - kink_m) <= reach_m) return false;
    }
  }
  return true;
}

double GatherLamp::scale_m(const Ball& ball) const {
  if (light_->parallel()) return INFINITY;
  const double h = emitter_from_body_.point(ball.centre_m).z();
  return std::min(h, h * std::tan(std::min(light_->angles().steepest_rad(), 0.8)));
}

double GatherLamp::typical_W_m2(const Ball& ball) const {
  if (light_->parallel()) return light_->exitance_W_m2();
  const double h = std::max(emitter_from_body_.point(ball.centre_m).z(), 0.0);
  return light_->typical_W_m2(h);
}

Integral<double> GatherLamp::power_W(std::span<const Vec3> corners_m, double tolerance_W) const {
  std::array<Vec3, 4> placed;
  for (size_t i = 0; i < corners_m.size(); ++i) placed[i] = emitter_from_body_.point(corners_m[i]);
  return light_->power_through_W(std::span(placed).first(corners_m.size()), tolerance_W);
}

}  // namespace photorque
