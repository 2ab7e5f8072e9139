#include "scenes/cad/part.h"

#include <algorithm>
#include <numeric>

namespace photorque::cad {
namespace {

Vec3 mean_normal(const std::vector<Vec3>& corners) {
  Vec3 normal = Vec3::Zero();
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i] - corners[0], b = corners[(i + 1) % corners.size()] - corners[0];
    normal += a.cross(b);
  }
  return normal;
}

// Projects the corners along the normal on a plane with right-handed axes.
std::vector<Vec2> flattened(const std::vector<Vec3>& corners, const Vec3& normal) {
  const Vec3 z = normal.normalized();
  Vec3::Index least = 0;
  z.cwiseAbs().minCoeff(&least);
  const Vec3 x = Vec3::Unit(least).cross(z).normalized(), y = z.cross(x);
  std::vector<Vec2> flat;
  for (const Vec3& corner : corners) {
    const Vec3 at = corner - corners[0];
    flat.emplace_back(at.dot(x), at.dot(y));
  }
  return flat;
}

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool is_inside(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

class EarClipper {
 public:
  explicit EarClipper(std::vector<Vec2> flat) : flat_(std::move(flat)), left_(flat_.size()) {
    std::iota(left_.begin(), left_.end(), 0u);
    for (size_t i = 0; i < left_.size(); ++i) is_ear_.push_back(finds_ear(i) ? 1 : 0);
  }

  std::vector<std::array<uint32_t, 3>> clip() {
    while (left_.size() > 3) cut(next_ear());
    triangles_.push_back({left_[0], left_[1], left_[2]});
    return std::move(triangles_);
  }

 private:
  size_t before(size_t i) const { return (i + left_.size() - 1) % left_.size(); }
  size_t after(size_t i) const { return (i + 1) % left_.size(); }
  bool turns_left(size_t i) const {
    return turn(flat_[left_[before(i)]], flat_[left_[i]], flat_[left_[after(i)]]) > 0.0;
  }

  bool finds_ear(size_t i) const {
    if (!turns_left(i)) return false;
    const Vec2 &a = flat_[left_[before(i)]], &b = flat_[left_[i]], &c = flat_[left_[after(i)]];
    for (const uint32_t other : left_) {
      const Vec2& p = flat_[other];
      // In a polygon with a slit to a hole, two corners have the same position.
      if (p == a || p == b || p == c) continue;
      if (is_inside(a, b, c, p)) return false;
    }
    return true;
  }

  // If no corner is an ear, the polygon intersects itself or is flat. A convex corner is then cut
  // off or, without one, the first corner.
  size_t next_ear() const {
    for (size_t i = 0; i < left_.size(); ++i) {
      if (is_ear_[i]) return i;
    }
    for (size_t i = 0; i < left_.size(); ++i) {
      if (turns_left(i)) return i;
    }
    return 0;
  }

  // Only the neighbours of the removed corner may change between ear and no ear.
  void cut(size_t i) {
    triangles_.push_back({left_[before(i)], left_[i], left_[after(i)]});
    left_.erase(left_.begin() + static_cast<ptrdiff_t>(i));
    is_ear_.erase(is_ear_.begin() + static_cast<ptrdiff_t>(i));
    const size_t next = i % left_.size();
    for (const size_t neighbour : {before(next), next}) {
      is_ear_[neighbour] = finds_ear(neighbour) ? 1 : 0;
    }
  }

  std::vector<Vec2> flat_;
  std::vector<uint32_t> left_;
  std::vector<uint8_t> is_ear_;  // for each remaining corner
  std::vector<std::array<uint32_t, 3>> triangles_;
};

}  // namespace

std::vector<std::array<uint32_t, 3>> triangles_of(const std::vector<Vec3>& corners) {
  if (corners.size() < 3) return {};
  if (corners.size() == 3) return {{0, 1, 2}};
  const Vec3 normal = mean_normal(corners);
  // A polygon without area has no normal; it is triangulated as a fan.
  if (!(normal.stableNorm() > 0.0) || !normal.allFinite()) {
    std::vector<std::array<uint32_t, 3>> fan;
    for (uint32_t i = 2; i < corners.size(); ++i) fan.push_back({0, i - 1, i});
    return fan;
  }
  return EarClipper(flattened(corners, normal)).clip();
}

bool crosses_itself(const std::vector<Vec3>& corners) {
  const size_t count = corners.size();
  Vec3 normal = mean_normal(corners), largest = Vec3::Zero();
  double size2 = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const Vec3 &a = corners[i], &b = corners[(i + 1) % count], &c = corners[(i + 2) % count];
    const Vec3 corner = (b - a).cross(c - b);
    if (corner.squaredNorm() > largest.squaredNorm()) largest = corner;
    size2 = std::max(size2, (b - a).squaredNorm());
  }
  constexpr double rounding = 1e-9;  // of the longest edge
  if (normal.norm() <= rounding * largest.norm()) normal = largest;
  if (count < 4 || !(normal.stableNorm() > 0.0) || !normal.allFinite()) return false;
  const std::vector<Vec2> flat = flattened(corners, normal);
  const auto apart = [&](const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
    const double from = turn(a, b, p), to = turn(a, b, q), least = rounding * size2;
    return (from > least && to < -least) || (from < -least && to > least);
  };
  for (size_t i = 0; i < count; ++i) {
    const Vec2 &a = flat[i], &b = flat[(i + 1) % count];
    for (size_t j = i + 2; j < count; ++j) {
      const Vec2 &p = flat[j], &q = flat[(j + 1) % count];
      if (apart(a, b, p, q) && apart(p, q, a, b)) return true;
    }
  }
  return false;
}

}  // namespace photorque::cad
