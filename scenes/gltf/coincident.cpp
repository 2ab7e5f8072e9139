#include "scenes/gltf/coincident.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>

#include "receivers/gather/bodies/facets.h"

namespace photorque {
namespace {

constexpr double tolerance = 1e-6, step = 2e-6;  // of the scene's size

struct Face {
  uint32_t instance, triangle;
  auto operator<=>(const Face&) const = default;
};

struct PlacedFace {
  Face face;
  std::array<Vec3, 3> corner_m;
  Vec3 normal, low_m, high_m;
};

// Faces in one plane have a key in common.
struct KeyedFace {
  uint64_t key;
  Face face;
};

// `front` comes before `behind` where both face alike; neither where they face opposite ways.
struct Pair {
  Face front, behind;
  bool opposite;
};

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

// Cells of the plane's normal and distance, without signs. A value near the border of two cells
// belongs to both; the borders avoid 0 and 1, where most faces are.
void add_keys(const PlacedFace& face, const Vec3& centre_m, double size_m,
              std::vector<KeyedFace>& keyed) {
  constexpr double cells = 512.0, shift = 0.37, margin = 0.02;  // of a cell
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

// Whether two triangles in one plane cover each other by more than `sliver_m` in every direction.
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

class Search {
 public:
  Search(const Scene& scene, double size_m) : scene_(scene), size_m_(size_m) {}

  // Among faces with one key.
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
    const double near_m = tolerance * size_m_;
    for (size_t i = 0; i < faces.size(); ++i) {
      const Vec3 low = faces[i].low_m.array() - near_m, high = faces[i].high_m.array() + near_m;
      for (size_t j = i + 1; j < faces.size(); ++j) {
        if (faces[j].low_m[along] > high[along]) break;
        if ((faces[j].low_m.array() > high.array()).any() ||
            (faces[j].high_m.array() < low.array()).any()) {
          continue;
        }
        compare(faces[i], faces[j]);
      }
    }
  }

  const std::vector<Pair>& pairs() const { return pairs_; }

 private:
  void compare(const PlacedFace& one, const PlacedFace& other) {
    const bool is_larger =
        (one.high_m - one.low_m).squaredNorm() >= (other.high_m - other.low_m).squaredNorm();
    const PlacedFace &large = is_larger ? one : other, &small = is_larger ? other : one;
    const double near_m = tolerance * size_m_;
    double height_m = 0.0;
    for (const Vec3& corner : small.corner_m) {
      const double at = large.normal.dot(corner - large.corner_m[0]);
      if (std::abs(at) > near_m) return;
      height_m += at / 3.0;
    }
    if (!overlap(one, other, 2.0 * near_m)) return;
    const bool opposite = one.normal.dot(other.normal) < 0.0;
    const bool two_parts = one.face.instance != other.face.instance;
    const bool solid = is_solid(one.face.instance), other_solid = is_solid(other.face.instance);
    if (opposite && two_parts && solid && other_solid) return;
    bool one_first = one.face < other.face;
    if (std::abs(height_m) > 1e-3 * near_m) {
      one_first = (height_m < 0.0) == is_larger;
    } else if (solid != other_solid) {
      one_first = !solid;
    }
    pairs_.push_back(
        {one_first ? one.face : other.face, one_first ? other.face : one.face, opposite});
  }

  bool is_solid(uint32_t instance) {
    const auto [entry, is_new] = solid_.try_emplace(instance, false);
    if (is_new) {
      const auto faces = faces_of(scene_, std::span(&instance, 1));
      entry->second = fronts_look_inwards(faces).has_value();
    }
    return entry->second;
  }

  const Scene& scene_;
  double size_m_;
  std::vector<Pair> pairs_;
  std::map<uint32_t, bool> solid_;
};

std::vector<Pair> find_pairs(const Scene& scene, const Vec3& centre_m, double size_m) {
  std::vector<KeyedFace> keyed;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const size_t count = scene.meshes[scene.instances[i].mesh].triangles.size();
    for (uint32_t t = 0; t < count; ++t) {
      const auto face = placed(scene, {i, t});
      if (face) add_keys(*face, centre_m, size_m, keyed);
    }
  }
  std::ranges::sort(keyed, [](const KeyedFace& a, const KeyedFace& b) {
    return a.key != b.key ? a.key < b.key : a.face < b.face;
  });
  Search search(scene, size_m);
  for (size_t begin = 0; begin < keyed.size();) {
    size_t end = begin + 1;
    while (end < keyed.size() && keyed[end].key == keyed[begin].key) ++end;
    search.among(std::span(keyed).subspan(begin, end - begin));
    begin = end;
  }
  return search.pairs();
}

// How many steps each face moves: one before its opposite, one before each that faces alike.
std::map<Face, int> levels_of(const std::vector<Pair>& pairs) {
  constexpr int most = 100;  // faces in one place; an order that contradicts itself ends there
  std::map<Face, int> levels;
  for (const Pair& pair : pairs) {
    for (const Face& face : {pair.front, pair.behind}) {
      int& level = levels[face];
      if (pair.opposite) level = std::max(level, 1);
    }
  }
  bool changed = true;
  for (int pass = 0; changed && pass < most; ++pass) {
    changed = false;
    for (const Pair& pair : pairs) {
      if (pair.opposite) continue;
      int& level = levels[pair.front];
      const int least = levels[pair.behind] + 1;
      changed = changed || level < least;
      level = std::max(level, least);
    }
  }
  return levels;
}

void move_faces(Scene& scene, const std::map<Face, int>& levels, double step_m) {
  std::vector<int> users(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++users[instance.mesh];
  uint32_t copied = UINT32_MAX;  // the last instance that was given a separate mesh
  for (const auto& [face, level] : levels) {
    if (level == 0) continue;
    const PlacedFace at = *placed(scene, face);
    Instance& instance = scene.instances[face.instance];
    if (copied != face.instance && users[instance.mesh] > 1) {
      --users[instance.mesh];
      const Mesh copy = scene.meshes[instance.mesh];
      instance.mesh = static_cast<uint32_t>(scene.meshes.size());
      scene.meshes.push_back(copy);
      users.push_back(1);
    }
    copied = face.instance;
    Mesh& mesh = scene.meshes[instance.mesh];
    const Vec3 by = instance.body_from_mesh.linear().inverse() * (level * step_m * at.normal);
    for (uint32_t& corner : mesh.triangles[face.triangle]) {
      const Vec3 moved = mesh.vertices_m[corner] + by;
      mesh.vertices_m.push_back(moved);
      if (!mesh.uv.empty()) mesh.uv.push_back(Vec2(mesh.uv[corner]));
      corner = static_cast<uint32_t>(mesh.vertices_m.size() - 1);
    }
  }
}

std::vector<std::string> lines_about(const Scene& scene, const std::vector<Pair>& pairs) {
  constexpr size_t most_lines = 5;
  std::map<std::tuple<bool, uint32_t, uint32_t>, std::set<Face>> by_parts;
  for (const Pair& pair : pairs) {
    auto [first, second] = std::pair(pair.front.instance, pair.behind.instance);
    if (pair.opposite && first > second) std::swap(first, second);
    auto& faces = by_parts[{pair.opposite, first, second}];
    faces.insert({pair.front, pair.behind});
  }
  using Entry = std::pair<std::tuple<bool, uint32_t, uint32_t>, std::set<Face>>;
  std::vector<Entry> most_first(by_parts.begin(), by_parts.end());
  std::ranges::stable_sort(most_first, std::greater<>(),
                           [](const Entry& entry) { return entry.second.size(); });
  std::vector<std::string> lines;
  for (const auto& [parts, faces] : most_first) {
    if (lines.size() == most_lines) {
      lines.push_back("faces that lie in each other: " +
                      std::to_string(most_first.size() - most_lines) + " more pairs of parts");
      break;
    }
    const auto& [opposite, first, second] = parts;
    const std::string a = "\"" + scene.instances[first].path + "\"";
    const std::string b = "\"" + scene.instances[second].path + "\"";
    const std::string count = std::to_string(faces.size()) + " triangles of ";
    const std::string whose = first == second ? a : a + " and " + b;
    lines.push_back(count + whose +
                    (opposite ? " lie in each other back to back: light meets each on its front"
                              : " lie in each other and face alike: only the first" +
                                    (first == second ? std::string() : ", of " + a + ",") +
                                    " meets light from the front"));
  }
  return lines;
}

}  // namespace

std::vector<std::string> separate_coincident_faces(Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const Instance& instance : scene.instances) {
    for (const Vec3& vertex : scene.meshes[instance.mesh].vertices_m) {
      box.extend(instance.body_from_mesh * vertex);
    }
  }
  if (box.isEmpty()) return {};
  const double size_m = 0.5 * box.diagonal().norm();
  const std::vector<Pair> pairs = find_pairs(scene, box.center(), size_m);
  if (pairs.empty()) return {};
  std::vector<std::string> lines = lines_about(scene, pairs);
  move_faces(scene, levels_of(pairs), step * size_m);
  return lines;
}

}  // namespace photorque
