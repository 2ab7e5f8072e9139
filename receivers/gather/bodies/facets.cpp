#include "receivers/gather/bodies/facets.h"

#include <algorithm>

#include "receivers/gather/bodies/inside.h"
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
  facet.ball = {(face.corner_body_m[0] + face.corner_body_m[1] + face.corner_body_m[2]) / 3.0, 0.0};
  for (const Vec3& corner : facet.corner_m) {
    facet.ball.radius_m = std::max(facet.ball.radius_m, (corner - facet.ball.centre_m).norm());
  }
  return facet;
}

// About the middle of the box that holds the facets.
Ball ball_about(std::span<const Facet> facets) {
  if (facets.empty()) return {Vec3::Zero(), 0.0};
  Vec3 low = facets[0].corner_m[0], high = low;
  for (const Facet& facet : facets) {
    for (const Vec3& corner : facet.corner_m) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

}  // namespace

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
  find_free(scene.radius_m());
}

// Of so many pairs of a facet and a corner it is worth looking at all; of more, at those of the
// largest facets.
void Facets::find_free(double scene_radius_m) {
  constexpr size_t most_pairs = 200'000'000;
  constexpr double rounding = 1e-6;  // of the scene: in the plane, as far as rays can tell
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

}  // namespace photorque
