#include "receivers/gather/bodies/facets.h"

#include <algorithm>
#include <map>
#include <vector>

#include "core/numerics/connected.h"
#include "receivers/surface_grid.h"

namespace photorque {
namespace {

Facet facet_of(const SurfaceFace& face) {
  Facet facet;
  facet.corner_m = face.corner_body_m;
  facet.area_m2 = face.area_body_m2.norm();
  facet.normal = face.area_body_m2 / facet.area_m2;
  facet.instance = face.instance;
  facet.triangle = face.triangle;
  facet.ball = ball_around(facet.corner_m);
  return facet;
}

// Ball about the centre of the box that contains the facets.
Ball ball_about(std::span<const Facet> facets) {
  if (facets.empty()) return {Vec3::Zero(), 0.0};
  Eigen::AlignedBox3d box;
  for (const Facet& facet : facets) {
    for (const Vec3& corner : facet.corner_m) box.extend(corner);
  }
  return {box.center(), 0.5 * box.diagonal().norm()};
}

}  // namespace

Ball ball_around(const TriangleCorners& corners_m) {
  Ball ball{(corners_m[0] + corners_m[1] + corners_m[2]) / 3.0, 0.0};
  for (const Vec3& corner : corners_m) {
    ball.radius_m = std::max(ball.radius_m, (corner - ball.centre_m).norm());
  }
  return ball;
}

Facets::Facets(const Scene& scene) {
  for (uint32_t instance = 0; instance < scene.instances.size(); ++instance) {
    first_.push_back(facets_.size());
    numbers_.emplace_back();
    const std::vector<SurfaceFace> faces = faces_of(scene, std::span(&instance, 1));
    for (const SurfaceFace& face : faces) {
      if (face.area_body_m2.norm() > 0.0) facets_.push_back(facet_of(face));
      numbers_.back().push_back(static_cast<uint32_t>(std::max<size_t>(facets_.size(), 1) - 1));
    }
    const auto own = std::span(facets_).subspan(first_.back());
    balls_.push_back(ball_about(own));
    inward_.push_back(fronts_look_inwards(faces));
  }
  first_.push_back(facets_.size());
  find_free(ball_about(facets_).radius_m);
}

double Facets::area_m2() const {
  double sum_m2 = 0.0;
  for (const Facet& facet : facets_) sum_m2 += facet.area_m2;
  return sum_m2;
}

// Finds the facets that nothing can shade. Compares facets with the corners of all others, for up
// to 2e8 pairs; beyond this limit only the largest facets are compared.
void Facets::find_free(double scene_radius_m) {
  constexpr size_t most_pairs = 200'000'000;
  // Fraction of the scene's radius: such corners are in the facet's plane, to the precision of
  // rays.
  constexpr double rounding = 1e-6;
  std::vector<size_t> order(facets_.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(
      order, [&](size_t a, size_t b) { return facets_[a].area_m2 > facets_[b].area_m2; });
  const size_t most = most_pairs / std::max<size_t>(3 * facets_.size(), 1);
  if (order.size() > most) order.resize(most);
  for (const size_t index : order) {
    Facet& facet = facets_[index];
    const double level_m = facet.normal.dot(facet.ball.centre_m);
    bool above = false, below = false;
    for (const Facet& other : facets_) {
      for (const Vec3& corner : other.corner_m) {
        const double height_m = facet.normal.dot(corner) - level_m;
        above = above || height_m > rounding * scene_radius_m;
        below = below || height_m < -rounding * scene_radius_m;
      }
      if (above && below) break;
    }
    facet.free = {!below, !above};
  }
}

std::optional<bool> fronts_look_inwards(std::span<const SurfaceFace> faces) {
  std::vector<Vec3> corners_m;
  for (const SurfaceFace& face : faces) {
    corners_m.insert(corners_m.end(), face.corner_body_m.begin(), face.corner_body_m.end());
  }
  const std::vector<uint32_t> places = welded(corners_m);  // three per face
  if (!edges_pair_up(places)) return std::nullopt;
  DisjointSets bodies(places.size());
  for (size_t f = 0; f < places.size(); f += 3) {
    const uint32_t a = places[f], b = places[f + 1], c = places[f + 2];
    if (a == b || b == c || c == a) continue;  // without area
    bodies.join(a, b);
    bodies.join(b, c);
  }
  struct Size {
    double volume_m3 = 0.0, area_m2 = 0.0, reach_m = 0.0;
  };
  std::map<size_t, Size> sizes;
  const Vec3 origin_m = faces.front().corner_body_m[0];
  for (size_t f = 0; f < faces.size(); ++f) {
    const Vec3 to_m = faces[f].corner_body_m[0] - origin_m;
    Size& size = sizes[bodies.root(places[3 * f])];
    size.volume_m3 += faces[f].area_body_m2.dot(to_m) / 3.0;
    size.area_m2 += faces[f].area_body_m2.norm();
    size.reach_m = std::max(size.reach_m, to_m.norm());
  }
  bool inwards = false, outwards = false;
  for (const auto& [body, size] : sizes) {
    // A fold without area that shares no corner with other bodies.
    if (size.area_m2 == 0.0) continue;
    // The inner side of a volume within rounding errors is undefined.
    constexpr double rounding = 1e-12;
    if (std::abs(size.volume_m3) <= rounding * size.area_m2 * size.reach_m) return std::nullopt;
    (size.volume_m3 < 0.0 ? inwards : outwards) = true;
  }
  if (inwards == outwards) return std::nullopt;
  return inwards;
}

}  // namespace photorque
