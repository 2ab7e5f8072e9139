#include "diagnosis/light/model/illumination.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/constants.h"

namespace photorque {
namespace {

bool crosses(const ShadowBox& box, const Vec3& from, const Vec3& to) {
  double enter = 0.0, leave = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double d = to[k] - from[k];
    if (std::abs(d) < 1e-15) {
      if (from[k] < box.low_m[k] || from[k] > box.high_m[k]) return false;
      continue;
    }
    const double a = (box.low_m[k] - from[k]) / d, b = (box.high_m[k] - from[k]) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave;
}

// Whether a sphere touches the straight line between two points.
bool may_reach(const Vec3& centre, double radius, const Vec3& from, const Vec3& to) {
  const Vec3 d = to - from;
  const double t = std::clamp((centre - from).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (from + t * d - centre).squaredNorm() < radius * radius;
}

// Whether a line from the point to a disc can cross a wall: false if point and disc are on one side
// of each of its triangles.
bool may_pass(const LightWall& wall, const Vec3& point, const Vec3& disc, double radius) {
  return std::ranges::any_of(wall.triangles, [&](const std::array<Vec3, 3>& t) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double from = normal.dot(point - t[0]), to = normal.dot(disc - t[0]);
    return !(from * to > 0.0) || std::abs(to) < radius * normal.norm();
  });
}

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Area and first moment of a part of the disc of radius 1.
struct DiscPart {
  double area = 0.0;
  Vec2 moment = Vec2::Zero();  // ∫ d dA

  DiscPart& operator+=(const DiscPart& other) {
    area += other.area;
    moment += other.moment;
    return *this;
  }
};

// Sector between two directions from the centre, signed by the direction of rotation.
DiscPart sector(const Vec2& p, const Vec2& q) {
  const Vec2 from = p.normalized(), to = q.normalized();
  return {0.5 * std::atan2(cross(p, q), p.dot(q)),
          Vec2(to.y() - from.y(), from.x() - to.x()) / 3.0};
}

// Intersection of the disc with the triangle of its centre and two points, signed likewise.
DiscPart disc_part(const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double square = d.squaredNorm(), along = a.dot(d);
  const double root2 = along * along - square * (a.squaredNorm() - 1.0);
  if (!(square > 0.0)) return {};
  if (root2 <= 0.0) return sector(a, b);
  const double root = std::sqrt(root2);
  const double enter = (-along - root) / square, leave = (-along + root) / square;
  if (leave <= 0.0 || enter >= 1.0) return sector(a, b);
  const Vec2 p = a + std::max(enter, 0.0) * d, q = a + std::min(leave, 1.0) * d;
  const double area = 0.5 * cross(p, q);
  DiscPart part{area, area / 3.0 * (p + q)};
  if (enter > 0.0) part += sector(a, p);
  if (leave < 1.0) part += sector(q, b);
  return part;
}

// Intersection of the disc and a polygon of either orientation.
DiscPart shared_with(std::span<const Vec2> polygon) {
  DiscPart sum;
  for (size_t i = 0; i < polygon.size(); ++i) {
    sum += disc_part(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
  return sum.area < 0.0 ? DiscPart{-sum.area, -sum.moment} : sum;
}

// Intersection of the disc and the convex hull of some points. The hull by A. Andrew, Information
// Processing Letters 9, 216 (1979).
DiscPart shared_with_hull(std::array<Vec2, 8>& points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::array<Vec2, 17> hull;
  size_t count = 0;
  const auto extend = [&](const Vec2& p, size_t least) {
    while (count >= least && cross(hull[count - 1] - hull[count - 2], p - hull[count - 2]) <= 0.0) {
      --count;
    }
    hull[count++] = p;
  };
  for (const Vec2& p : points) extend(p, 2);
  const size_t least = count + 1;
  for (size_t i = points.size() - 1; i-- > 0;) extend(points[i], least);
  return shared_with({hull.data(), count - 1});
}

Obstacles::Open without(const DiscPart& hidden, double opacity) {
  const double part = opacity / pi;
  return {std::clamp(1.0 - part * hidden.area, 0.0, 1.0), -part * hidden.moment};
}

// A point's view of an aperture, in units of its radius.
class View {
 public:
  View(const Vec3& point, const Vec3& lamp, const Vec3& side, const Vec3& up)
      : point_(point), away_(lamp - point), side_(side), up_(up), normal_(side.cross(up)) {
    height_ = normal_.dot(away_);
  }
  // Fraction of the distance to the plane of the aperture.
  double part(const Vec3& at) const { return normal_.dot(at - point_) / height_; }
  // Projection of parts that are neither behind the point nor beyond the aperture.
  Vec2 project(const Vec3& at) const {
    const Vec3 there = (at - point_) / part(at) - away_;
    return Vec2(there.dot(side_), there.dot(up_)) / side_.squaredNorm();
  }

 private:
  Vec3 point_, away_, side_, up_, normal_;
  double height_;
};

constexpr double nearest_part = 1e-4;

// The part of the aperture that a sheet hides; parts behind the point hide nothing. Returns nothing
// for other walls, whose triangles may overlap, and for a sheet that extends beyond the plane of
// the aperture.
std::optional<DiscPart> hidden_by(const LightWall& wall, const View& view) {
  if (!wall.is_sheet) return std::nullopt;
  DiscPart hidden;
  for (const std::array<Vec3, 3>& t : wall.triangles) {
    std::array<Vec2, 4> seen;
    size_t corners = 0;
    for (size_t i = 0; i < t.size(); ++i) {
      const Vec3 &a = t[i], &b = t[(i + 1) % t.size()];
      const double from = view.part(a) - nearest_part, to = view.part(b) - nearest_part;
      if (from >= 1.0 - nearest_part) return std::nullopt;
      if (from > 0.0) seen[corners++] = view.project(a);
      if ((from > 0.0) != (to > 0.0)) {
        seen[corners++] = view.project(a + from / (from - to) * (b - a));
      }
    }
    hidden += shared_with({seen.data(), corners});
  }
  return hidden;
}

}  // namespace

std::vector<Vec2> even_disc(size_t count) {
  const double golden = pi * (3.0 - std::sqrt(5.0));
  std::vector<Vec2> points;
  for (size_t i = 0; i < count; ++i) {
    const double r = std::sqrt((static_cast<double>(i) + 0.5) / static_cast<double>(count));
    points.emplace_back(r * std::cos(golden * static_cast<double>(i)),
                        r * std::sin(golden * static_cast<double>(i)));
  }
  return points;
}

bool crosses(const std::array<Vec3, 3>& t, const Vec3& from, const Vec3& to) {
  const Vec3 d = to - from, a = t[1] - t[0], b = t[2] - t[0], n = d.cross(b);
  const double det = a.dot(n);
  if (std::abs(det) < 1e-18) return false;
  const Vec3 s = from - t[0];
  const double u = s.dot(n) / det;
  if (u < 0.0 || u > 1.0) return false;
  const Vec3 q = s.cross(a);
  const double v = d.dot(q) / det, along = b.dot(q) / det;
  constexpr double touch = 1e-9;  // excludes the surfaces at both ends
  return v >= 0.0 && u + v <= 1.0 && along > touch && along < 1.0 - touch;
}

Obstacles::Obstacles(const LightLab& lab, const std::vector<ShadowBox>& boxes,
                     const Quat& lab_from_body)
    : lab_(lab), boxes_(boxes), lab_from_body_(lab_from_body) {
  for (const ShadowBox& box : boxes) {
    BodyBox b;
    const Quat body_from_box = box.on_body ? Quat::Identity() : lab_from_body.conjugate();
    for (size_t k = 0; k < b.corners.size(); ++k) {
      const Vec3 corner((k & 1) != 0 ? box.high_m.x() : box.low_m.x(),
                        (k & 2) != 0 ? box.high_m.y() : box.low_m.y(),
                        (k & 4) != 0 ? box.high_m.z() : box.low_m.z());
      b.corners[k] = body_from_box * corner;
    }
    b.centre = body_from_box * Vec3(0.5 * (box.low_m + box.high_m));
    b.radius = 0.5 * (box.high_m - box.low_m).norm();
    in_body_.push_back(b);
  }
}

bool Obstacles::meets_boxes(const Vec3& point, const Vec3& lamp, double radius_m) const {
  return std::ranges::any_of(in_body_, [&](const BodyBox& box) {
    return may_reach(box.centre, box.radius + radius_m, point, lamp);
  });
}

Obstacles::Open Obstacles::visible(const Vec3& point, const Vec3& lamp, const Vec3& side,
                                   const Vec3& up, size_t skipped) const {
  const double radius = side.norm();
  near_walls_.clear();
  near_boxes_.clear();
  for (size_t w = 0; w < lab_.walls().size(); ++w) {
    const LightWall& wall = lab_.walls()[w];
    if (w != skipped && may_reach(wall.centre_m, wall.radius_m + radius, point, lamp) &&
        may_pass(wall, point, lamp, radius)) {
      near_walls_.push_back(w);
    }
  }
  for (size_t b = 0; b < boxes_.size(); ++b) {
    if (may_reach(in_body_[b].centre, in_body_[b].radius + radius, point, lamp)) {
      near_boxes_.push_back(b);
    }
  }
  if (near_walls_.empty() && near_boxes_.empty()) return {};
  if (near_walls_.size() + near_boxes_.size() > 1 || !(radius > 0.0)) {
    return sampled(point, lamp, side, up);
  }
  const View view(point, lamp, side, up);
  if (!near_walls_.empty()) {
    const std::optional<DiscPart> hidden = hidden_by(lab_.walls()[near_walls_.front()], view);
    return hidden ? without(*hidden, 1.0) : sampled(point, lamp, side, up);
  }
  const BodyBox& box = in_body_[near_boxes_.front()];
  std::array<Vec2, 8> seen;
  for (size_t k = 0; k < seen.size(); ++k) {
    const double part = view.part(box.corners[k]);
    if (!(part > nearest_part && part < 1.0)) return sampled(point, lamp, side, up);
    seen[k] = view.project(box.corners[k]);
  }
  return without(shared_with_hull(seen), boxes_[near_boxes_.front()].opacity);
}

Obstacles::Open Obstacles::sampled(const Vec3& point, const Vec3& lamp, const Vec3& side,
                                   const Vec3& up) const {
  static const std::vector<Vec2> disc = even_disc(100);
  Open open{0.0, Vec2::Zero()};
  const Vec3 point_lab = lab_from_body_ * point;
  for (const Vec2& d : disc) {
    const Vec3 to = lamp + d.x() * side + d.y() * up;
    double passes = 1.0;
    for (const size_t w : near_walls_) {
      const auto& triangles = lab_.walls()[w].triangles;
      if (std::ranges::any_of(triangles, [&](const auto& t) { return crosses(t, point, to); })) {
        passes = 0.0;
        break;
      }
    }
    for (const size_t b : near_boxes_) {
      const ShadowBox& box = boxes_[b];
      const bool hit =
          box.on_body ? crosses(box, point, to) : crosses(box, point_lab, lab_from_body_ * to);
      if (hit) passes *= 1.0 - box.opacity;
    }
    open.fraction += passes / static_cast<double>(disc.size());
    open.moment += passes / static_cast<double>(disc.size()) * d;
  }
  return open;
}

}  // namespace photorque
