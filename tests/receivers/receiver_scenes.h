// Small scenes, hits and settings made by hand, for tests of receivers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/constants.h"
#include "raytrace/receiver.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque::fixtures {

// The rectangle [x0, x1] × [y0, y1] at height z, front up, texture coordinates from 0 to 1.
inline Mesh plate(double x0, double x1, double y0, double y1, double z = 0.0) {
  return rectangle({0.5 * (x0 + x1), 0.5 * (y0 + y1), z}, {x1 - x0, 0, 0}, {0, y1 - y0, 0});
}

// Adds a mesh with separate vertices.
inline void append(Mesh& all, const Mesh& more) {
  const auto first = static_cast<uint32_t>(all.vertices_m.size());
  all.vertices_m.insert(all.vertices_m.end(), more.vertices_m.begin(), more.vertices_m.end());
  all.uv.insert(all.uv.end(), more.uv.begin(), more.uv.end());
  for (const auto& t : more.triangles) {
    all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

// The polygon with corners on the circle of radius 1, first corner on +x, front up.
inline Mesh polygon(uint32_t corners) {
  Mesh mesh;
  mesh.vertices_m.emplace_back(0, 0, 0);
  for (uint32_t i = 0; i < corners; ++i) {
    const double angle = 2 * pi * i / corners;
    mesh.vertices_m.emplace_back(std::cos(angle), std::sin(angle), 0);
    mesh.triangles.push_back({0, i + 1, (i + 1) % corners + 1});
  }
  return mesh;
}

// The ring between two regular polygons with corners on circles of the given radii.
inline Mesh ring(uint32_t corners, double inner_m, double outer_m) {
  Mesh mesh;
  for (uint32_t i = 0; i < corners; ++i) {
    const Vec3 direction(std::cos(2 * pi * i / corners), std::sin(2 * pi * i / corners), 0);
    mesh.vertices_m.push_back(inner_m * direction);
    mesh.vertices_m.push_back(outer_m * direction);
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % corners);
    mesh.triangles.push_back({a, a + 1, b + 1});
    mesh.triangles.push_back({a, b + 1, b});
  }
  return mesh;
}

inline uint32_t add_instance(Scene& scene, Mesh mesh, const std::string& path,
                             const Affine& body_from_mesh = Affine::Identity()) {
  Instance instance;
  instance.path = path;
  instance.node = path.substr(path.find_last_of('/') + 1);
  instance.mesh = static_cast<uint32_t>(scene.meshes.size());
  instance.body_from_mesh = body_from_mesh;
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back(std::move(instance));
  return static_cast<uint32_t>(scene.instances.size() - 1);
}

inline Scene scene_of(Mesh mesh, const Affine& body_from_mesh = Affine::Identity()) {
  Scene scene;
  add_instance(scene, std::move(mesh), "plate", body_from_mesh);
  return scene;
}

struct HitMaker {
  uint32_t instance = 0;
  uint32_t triangle = 0;
  bool front = true;
  Vec3 position_m = Vec3::Zero();
  Vec2 barycentric = Vec2(0.25, 0.25);
  std::vector<double> incident_W = {1.0};
  std::vector<double> absorbed_W = {1.0};
  Vec3 force_N = Vec3::Zero();
  double cosine = 1.0;
};

inline void add_hit(Hits& hits, const HitMaker& hit) {
  const auto i = static_cast<size_t>(hits.count++);
  hits.instance.at(i) = hit.instance;
  hits.triangle[i] = hit.triangle;
  hits.front[i] = hit.front ? 1 : 0;
  hits.cosine[i] = hit.cosine;
  hits.bands = static_cast<int>(hit.incident_W.size());
  for (size_t band = 0; band < hit.incident_W.size(); ++band) {
    hits.incident_W[band][i] = hit.incident_W[band];
    hits.absorbed_W[band][i] = hit.absorbed_W[band];
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    hits.position_m[axis][i] = hit.position_m[static_cast<Eigen::Index>(axis)];
    hits.force_N[axis][i] = hit.force_N[static_cast<Eigen::Index>(axis)];
  }
  hits.barycentric[0][i] = static_cast<float>(hit.barycentric.x());
  hits.barycentric[1][i] = static_cast<float>(hit.barycentric.y());
}

// Hits is too large for comfort on a stack.
inline std::unique_ptr<Hits> hits_of(const std::vector<HitMaker>& all) {
  auto hits = std::make_unique<Hits>();
  hits->count = 0;
  for (const HitMaker& hit : all) add_hit(*hits, hit);
  return hits;
}

// One replicate per list of hits, of any length.
inline BinSums sums_of(const Receiver& receiver, const std::vector<std::vector<HitMaker>>& lists) {
  BinSums sums{receiver.bins(), static_cast<int>(lists.size()), {}};
  sums.sums.assign(sums.bins * lists.size(), 0.0);
  for (size_t r = 0; r < lists.size(); ++r) {
    const auto bins = std::span(sums.sums).subspan(r * sums.bins, sums.bins);
    for (size_t begin = 0; begin < lists[r].size(); begin += Hits::capacity) {
      const size_t end = std::min<size_t>(begin + Hits::capacity, lists[r].size());
      receiver.score(*hits_of({lists[r].begin() + static_cast<std::ptrdiff_t>(begin),
                               lists[r].begin() + static_cast<std::ptrdiff_t>(end)}),
                     bins);
    }
  }
  return sums;
}

inline const Map& map_named(const Product& product, const std::string& name) {
  for (const Map& map : product.maps) {
    if (map.name == name) return map;
  }
  throw std::runtime_error("no map " + name);
}

inline Estimate quantity_named(const Product& product, const std::string& name) {
  for (const Quantity& quantity : product.quantities) {
    if (quantity.name == name) return quantity.estimate;
  }
  throw std::runtime_error("no quantity " + name);
}

}  // namespace photorque::fixtures
