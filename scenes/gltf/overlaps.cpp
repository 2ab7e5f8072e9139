#include "scenes/gltf/overlaps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <tuple>

#include "core/numerics/divide_convex.h"
#include "receivers/gather/bodies/facets.h"

namespace photorque {

double size_m(const Scene& scene) {
  const Eigen::AlignedBox3d box = scene.box();
  return box.isEmpty() ? 0.0 : 0.5 * box.diagonal().norm();
}

std::optional<bool> Parts::inward(uint32_t part) {
  const auto [entry, is_new] = inward_.try_emplace(part);
  if (is_new) entry->second = fronts_look_inwards(faces_of(scene_, std::span(&part, 1)));
  return entry->second;
}

std::optional<PlacedFace> placed(const Scene& scene, const Face& face) {
  const Instance& instance = scene.instances[face.instance];
  const Mesh& mesh = scene.meshes[instance.mesh];
  PlacedFace result{face, {}, {}, {}, {}};
  for (size_t k = 0; k < 3; ++k) {
    result.corner_m[k] =
        instance.body_from_mesh * mesh.vertices_m[mesh.triangles[face.triangle][k]];
  }
  const auto& [a, b, c] = result.corner_m;
  const Vec3 cross = (b - a).cross(c - a);
  const double length = cross.norm();
  if (!(length > 0.0)) return std::nullopt;
  const bool mirrored = instance.body_from_mesh.linear().determinant() < 0.0;
  result.normal = cross / (mirrored ? -length : length);
  result.low_m = a.cwiseMin(b).cwiseMin(c);
  result.high_m = a.cwiseMax(b).cwiseMax(c);
  return result;
}

namespace {

constexpr double sliver = 1e-5;        // faces that overlap over a smaller width are neighbours
constexpr double slight = 5e-4;        // maximum angle between faces that touch or cross [rad]
constexpr double most_rounded = 2e-3;  // maximum angle by which rounded corners turn a face [rad]

// A face with one of its search keys. Faces in the same plane share a key.
struct KeyedFace {
  uint64_t key;
  Face face;
};

// Maximum angle [rad] between a face and one that coincides with it. A small face is turned more by
// the rounding of its corners.
double angle_of(const PlacedFace& face, double size_m) {
  const auto& [a, b, c] = face.corner_m;
  const double longest_m = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const double height_m = (b - a).cross(c - a).norm() / longest_m;
  return std::clamp(coincidence_tolerance * size_m / height_m, slight, most_rounded);
}

// Adds search keys: cells of the absolute values of the plane's normal and distance. A value near
// the border of two cells belongs to both. The shift moves the borders away from 0 and 1, where
// most faces are.
void add_keys(const PlacedFace& face, const Vec3& centre_m, double size_m,
              std::vector<KeyedFace>& keyed) {
  constexpr double cells = 64.0, shift = 0.37;
  const double margin = 1.01 * cells * angle_of(face, size_m);  // of a cell
  const double distance = face.normal.dot(face.corner_m[0] - centre_m) / size_m;
  std::vector<uint64_t> keys = {0};
  for (const double value : {face.normal.x(), face.normal.y(), face.normal.z(), distance}) {
    const double place = cells * std::abs(value) + shift;
    const auto first = static_cast<uint64_t>(std::floor(place - margin));
    const auto last = static_cast<uint64_t>(std::floor(place + margin));
    const size_t count = keys.size();
    for (size_t i = 0; i < count; ++i) {
      keys[i] = (keys[i] << 10) | first;
      if (last != first) keys.push_back(keys[i] + 1);
    }
  }
  for (const uint64_t key : keys) keyed.push_back({key, face.face});
}

// Part of a convex polygon on the side of a plane to which `normal` points.
std::vector<Vec3> part_before(const std::vector<Vec3>& polygon, const Vec3& normal,
                              const Vec3& point_m) {
  std::vector<Vec3> part;
  divide_convex(
      std::span(polygon), [&](const Vec3& at) { return normal.dot(at - point_m); },
      [&](const Vec3& at, double side) {
        if (side >= 0.0) part.push_back(at);
      });
  return part;
}

// Whether two triangles in one plane overlap by more than `sliver_m` in every direction.
bool overlap(const PlacedFace& a, const PlacedFace& b, double sliver_m) {
  for (const PlacedFace* edges : {&a, &b}) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 edge = edges->corner_m[(k + 1) % 3] - edges->corner_m[k];
      const Vec3 across = edges->normal.cross(edge).normalized();
      std::array<double, 2> low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
      for (size_t i = 0; i < 3; ++i) {
        const std::array<double, 2> at = {across.dot(a.corner_m[i] - edges->corner_m[k]),
                                          across.dot(b.corner_m[i] - edges->corner_m[k])};
        for (size_t side = 0; side < 2; ++side) {
          low[side] = std::min(low[side], at[side]);
          high[side] = std::max(high[side], at[side]);
        }
      }
      if (std::min(high[0], high[1]) - std::max(low[0], low[1]) <= sliver_m) return false;
    }
  }
  return true;
}

// Minimum and maximum height of `small` above the plane of `large` within their overlap; empty if
// they do not overlap. The overlap of two triangles in nearly the same plane has at most six
// corners.
std::optional<std::array<double, 2>> heights_over(const PlacedFace& large,
                                                  const PlacedFace& small) {
  std::vector<Vec3> polygon(small.corner_m.begin(), small.corner_m.end());
  for (size_t k = 0; k < 3; ++k) {
    const Vec3 edge = large.corner_m[(k + 1) % 3] - large.corner_m[k];
    const Vec3 opposite = large.corner_m[(k + 2) % 3] - large.corner_m[k];
    Vec3 inwards = large.normal.cross(edge);
    if (inwards.dot(opposite) < 0.0) inwards = -inwards;
    polygon = part_before(polygon, inwards, large.corner_m[k]);
  }
  if (polygon.empty()) return std::nullopt;
  std::array<double, 2> heights = {INFINITY, -INFINITY};
  for (const Vec3& corner : polygon) {
    const double at = large.normal.dot(corner - large.corner_m[0]);
    heights = {std::min(heights[0], at), std::max(heights[1], at)};
  }
  return heights;
}

class Search {
 public:
  Search(const Scene& scene, Parts& parts, double size_m)
      : scene_(scene), parts_(parts), size_m_(size_m) {}

  // Compares all faces with one key.
  void among(std::span<const KeyedFace> some) {
    if (some.size() < 2) return;
    std::vector<PlacedFace> faces;
    Vec3 low_m = Vec3::Constant(INFINITY), high_m = -low_m;
    for (const KeyedFace& one : some) {
      faces.push_back(*placed(scene_, one.face));
      low_m = low_m.cwiseMin(faces.back().low_m);
      high_m = high_m.cwiseMax(faces.back().high_m);
    }
    Eigen::Index along = 0;
    (high_m - low_m).maxCoeff(&along);
    std::ranges::sort(faces, [&](const PlacedFace& a, const PlacedFace& b) {
      return a.low_m[along] < b.low_m[along];
    });
    const double near_m = coincidence_tolerance * size_m_;
    for (size_t i = 0; i < faces.size(); ++i) {
      const Vec3 low = faces[i].low_m.array() - near_m, high = faces[i].high_m.array() + near_m;
      for (size_t j = i + 1; j < faces.size(); ++j) {
        if (faces[j].low_m[along] > high[along]) break;
        if ((faces[j].low_m.array() > high.array()).any() ||
            (faces[j].high_m.array() < low.array()).any()) {
          continue;
        }
        const bool in_order = faces[i].face < faces[j].face;
        compare(faces[in_order ? i : j], faces[in_order ? j : i]);
      }
    }
  }

  // Each pair once; faces may share several keys.
  std::vector<Pair> pairs() {
    const auto faces = [](const Pair& pair) { return std::tie(pair.one, pair.other); };
    std::ranges::sort(pairs_, std::less<>(), faces);
    const auto rest = std::ranges::unique(pairs_, std::equal_to<>(), faces);
    pairs_.erase(rest.begin(), rest.end());
    return std::move(pairs_);
  }

 private:
  void compare(const PlacedFace& one, const PlacedFace& other) {
    const double sine = one.normal.cross(other.normal).norm();
    if (sine > std::max(angle_of(one, size_m_), angle_of(other, size_m_))) return;
    const double near_m = coincidence_tolerance * size_m_;
    const bool is_larger =
        (one.high_m - one.low_m).squaredNorm() >= (other.high_m - other.low_m).squaredNorm();
    const PlacedFace &large = is_larger ? one : other, &small = is_larger ? other : one;
    std::array<double, 3> corner_m{};
    for (size_t k = 0; k < 3; ++k) {
      corner_m[k] = large.normal.dot(small.corner_m[k] - large.corner_m[0]);
    }
    const auto [lowest_m, highest_m] = std::ranges::minmax(corner_m);
    if (lowest_m > near_m || highest_m < -near_m) return;
    if (!overlap(one, other, sliver * size_m_)) return;
    const auto heights = heights_over(large, small);
    if (!heights) return;
    auto [low_m, high_m] = *heights;
    if (low_m > near_m || high_m < -near_m) return;
    const bool opposite = one.normal.dot(other.normal) < 0.0;
    if (!opposite && !is_larger) std::tie(low_m, high_m) = std::pair(-high_m, -low_m);
    const bool coincident = low_m >= -near_m && high_m <= near_m;
    if (!coincident && sine > slight) return;
    if (opposite && within_solids(one.face, other.face, coincident, low_m + high_m)) return;
    const bool crosses = low_m < -near_m && high_m > near_m;
    pairs_.push_back({one.face, other.face, opposite,
                      coincident ? Relation::coincident
                      : crosses  ? Relation::crossing
                                 : Relation::touching,
                      low_m, high_m});
  }

  // Whether no light gets between two opposite faces: of solids that touch, or of one solid.
  bool within_solids(const Face& one, const Face& other, bool coincident, double twice_m) {
    if (!parts_.solids(one.instance, other.instance)) return false;
    if (one.instance == other.instance)
      return !coincident || twice_m > 2.0 * single_rounding * size_m_;
    if (!coincident && twice_m <= 0.0) return true;
    return !parts_.transmits(one.instance) && !parts_.transmits(other.instance);
  }

  const Scene& scene_;
  Parts& parts_;
  double size_m_;
  std::vector<Pair> pairs_;
};

// Cuts a triangle of a mesh along a plane (in the mesh's frame) into two or three triangles. Does
// nothing if the part on one side is a sliver.
void cut_triangle(Mesh& mesh, uint32_t triangle, const Vec3& normal, const Vec3& point_m) {
  constexpr double sliver = 1e-9;  // of the triangle's area
  const std::array<uint32_t, 3> corners = mesh.triangles[triangle];
  const auto area_m2 = [&](const std::array<uint32_t, 3>& of) {
    const Vec3& a = mesh.vertices_m[of[0]];
    return 0.5 * (mesh.vertices_m[of[1]] - a).cross(mesh.vertices_m[of[2]] - a).norm();
  };
  std::array<double, 3> side{};
  for (size_t k = 0; k < 3; ++k) side[k] = normal.dot(mesh.vertices_m[corners[k]] - point_m);
  std::array<std::vector<uint32_t>, 2> parts;  // in front of the plane, behind it
  for (size_t k = 0; k < 3; ++k) {
    const size_t next = (k + 1) % 3;
    parts[side[k] < 0.0].push_back(corners[k]);
    if ((side[k] < 0.0) == (side[next] < 0.0)) continue;
    const double part = side[k] / (side[k] - side[next]);
    const auto between = [&](const auto& values) {
      return (values[corners[k]] + part * (values[corners[next]] - values[corners[k]])).eval();
    };
    const Vec3 at_m = between(mesh.vertices_m);
    mesh.vertices_m.push_back(at_m);
    if (!mesh.uv.empty()) {
      const Vec2 uv = between(mesh.uv);
      mesh.uv.push_back(uv);
    }
    for (auto& one : parts) one.push_back(static_cast<uint32_t>(mesh.vertices_m.size() - 1));
  }
  std::vector<std::array<uint32_t, 3>> pieces;
  for (const auto& part : parts) {
    const size_t before = pieces.size();
    for (size_t k = 2; k < part.size(); ++k) {
      const std::array<uint32_t, 3> piece = {part[0], part[k - 1], part[k]};
      if (area_m2(piece) > sliver * area_m2(corners)) pieces.push_back(piece);
    }
    if (pieces.size() == before) return;
  }
  mesh.triangles[triangle] = pieces[0];
  mesh.triangles.insert(mesh.triangles.end(), pieces.begin() + 1, pieces.end());
}

}  // namespace

std::vector<Pair> find_pairs(const Scene& scene, Parts& parts) {
  const double extent_m = size_m(scene);
  const Vec3 centre_m = scene.box().center();
  std::vector<KeyedFace> keyed;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const size_t count = scene.meshes[scene.instances[i].mesh].triangles.size();
    for (uint32_t t = 0; t < count; ++t) {
      const auto face = placed(scene, {i, t});
      if (face) add_keys(*face, centre_m, extent_m, keyed);
    }
  }
  std::ranges::sort(keyed, [](const KeyedFace& a, const KeyedFace& b) {
    return a.key != b.key ? a.key < b.key : a.face < b.face;
  });
  Search search(scene, parts, extent_m);
  for (size_t begin = 0; begin < keyed.size();) {
    size_t end = begin + 1;
    while (end < keyed.size() && keyed[end].key == keyed[begin].key) ++end;
    search.among(std::span(keyed).subspan(begin, end - begin));
    begin = end;
  }
  return search.pairs();
}

bool cut_crossings(Scene& scene, const std::vector<Pair>& pairs) {
  constexpr size_t most = 10000;  // cuts
  struct Cut {
    Face face;
    Vec3 normal, point_m;
  };
  std::vector<Cut> cuts;
  for (const Pair& pair : pairs) {
    if (pair.relation != Relation::crossing || cuts.size() >= most) continue;
    for (const auto& [face, by] :
         {std::pair(pair.one, pair.other), std::pair(pair.other, pair.one)}) {
      const PlacedFace plane = *placed(scene, by);
      const auto& body_from_mesh = scene.instances[face.instance].body_from_mesh;
      cuts.push_back({face, body_from_mesh.linear().transpose() * plane.normal,
                      body_from_mesh.inverse() * plane.corner_m[0]});
    }
  }
  OwnMeshes meshes(scene);
  std::map<Face, std::vector<uint32_t>> pieces;  // by the face that is cut
  for (const Cut& cut : cuts) {
    std::vector<uint32_t>& of = pieces.try_emplace(cut.face, 1, cut.face.triangle).first->second;
    Mesh& mesh = meshes.of(cut.face.instance);
    for (size_t i = 0, before = of.size(); i < before; ++i) {
      auto next = static_cast<uint32_t>(mesh.triangles.size());
      cut_triangle(mesh, of[i], cut.normal, cut.point_m);
      for (; next < mesh.triangles.size(); ++next) of.push_back(next);
    }
  }
  return !cuts.empty();
}

}  // namespace photorque
