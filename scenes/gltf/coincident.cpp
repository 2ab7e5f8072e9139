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

constexpr double tolerance = 1e-6, step = 2e-6;  // fractions of the scene's size
constexpr double slight = 5e-4;  // maximum angle between faces that touch or cross [rad]

struct Face {
  uint32_t instance, triangle;
  auto operator<=>(const Face&) const = default;
};

struct PlacedFace {
  Face face;
  std::array<Vec3, 3> corner_m;
  Vec3 normal, low_m, high_m;
};

// A face with one of its search keys. Faces in the same plane share a key.
struct KeyedFace {
  uint64_t key;
  Face face;
};

// Relative position of two overlapping faces.
enum class Relation {
  coincident,  // within the tolerance over the whole overlap
  touching,    // within the tolerance at one end; `front` is in front of `behind`
  parted,      // within the tolerance at one end; the fronts face each other
  crossing,
};

// Two faces. If both face alike, `front` comes first; if they face opposite ways, the order has no
// meaning.
struct Pair {
  Face front, behind;
  bool opposite;
  Relation relation;
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

// Adds search keys: cells of the absolute values of the plane's normal and distance. A value near
// the border of two cells belongs to both. The shift moves the borders away from 0 and 1, where
// most faces are.
void add_keys(const PlacedFace& face, const Vec3& centre_m, double size_m,
              std::vector<KeyedFace>& keyed) {
  constexpr double cells = 64.0, shift = 0.37, margin = 1.01 * slight * cells;  // of a cell
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
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double from = normal.dot(a - point_m), to = normal.dot(b - point_m);
    if (from >= 0.0) part.push_back(a);
    if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0)) {
      part.push_back(a + from / (from - to) * (b - a));
    }
  }
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
  Search(const Scene& scene, double size_m) : scene_(scene), size_m_(size_m) {}

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
    if (one.normal.cross(other.normal).norm() > slight) return;
    const double near_m = tolerance * size_m_;
    const bool is_larger =
        (one.high_m - one.low_m).squaredNorm() >= (other.high_m - other.low_m).squaredNorm();
    const PlacedFace &large = is_larger ? one : other, &small = is_larger ? other : one;
    std::array<double, 3> corner_m{};
    for (size_t k = 0; k < 3; ++k) {
      corner_m[k] = large.normal.dot(small.corner_m[k] - large.corner_m[0]);
    }
    const auto [lowest_m, highest_m] = std::ranges::minmax(corner_m);
    if (lowest_m > near_m || highest_m < -near_m) return;
    if (!overlap(one, other, 2.0 * near_m)) return;
    const auto heights = heights_over(large, small);
    if (!heights) return;
    const auto [low_m, high_m] = *heights;
    if (low_m > near_m || high_m < -near_m) return;
    const bool opposite = one.normal.dot(other.normal) < 0.0;
    const bool two_parts = one.face.instance != other.face.instance;
    const std::optional<bool> inward = fronts_inward(one.face.instance);
    const std::optional<bool> other_inward = fronts_inward(other.face.instance);
    const bool solid = inward.has_value(), other_solid = other_inward.has_value();
    const bool coincident = low_m >= -near_m && high_m <= near_m;
    // Not a solid and its lining, which is on the same side.
    const bool touching_solids = opposite && solid && inward == other_inward;
    if (touching_solids && (two_parts || !coincident)) return;
    const double middle_m = 0.5 * (low_m + high_m);
    bool one_first = one.face < other.face;
    if (std::abs(middle_m) > 1e-3 * near_m) {
      one_first = (middle_m < 0.0) == is_larger;
    } else if (solid != other_solid) {
      one_first = !solid;
    }
    Relation relation = Relation::coincident;
    if (!coincident) {
      relation = low_m < -near_m && high_m > near_m ? Relation::crossing
                 : opposite && middle_m > 0.0       ? Relation::parted
                                                    : Relation::touching;
    }
    pairs_.push_back(
        {one_first ? one.face : other.face, one_first ? other.face : one.face, opposite, relation});
  }

  std::optional<bool> fronts_inward(uint32_t instance) {
    const auto [entry, is_new] = inward_.try_emplace(instance);
    if (is_new) entry->second = fronts_look_inwards(faces_of(scene_, std::span(&instance, 1)));
    return entry->second;
  }

  const Scene& scene_;
  double size_m_;
  std::vector<Pair> pairs_;
  std::map<uint32_t, std::optional<bool>> inward_;  // see fronts_look_inwards()
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

// Number of steps by which each face is displaced along its normal. A face moves one step forwards
// from an opposite face, and one step in front of each face behind it with equal orientation. It
// moves backwards from a face whose front faces it.
std::map<Face, int> levels_of(const std::vector<Pair>& pairs) {
  constexpr int most = 100;  // limit for a contradictory order of faces
  std::map<Face, int> levels;
  for (const Pair& pair : pairs) {
    if (pair.relation == Relation::parted) continue;
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
  for (const Pair& pair : pairs) {
    if (pair.relation != Relation::parted) continue;
    int &one = levels[pair.front], &other = levels[pair.behind];
    if (one + other < 0) continue;
    if (one <= 0) {
      one = -other - 1;
    } else if (other <= 0) {
      other = -one - 1;
    }
  }
  return levels;
}

// Gives some instances their own copies of meshes that other instances use, too.
class OwnMeshes {
 public:
  explicit OwnMeshes(Scene& scene) : scene_(scene), users_(scene.meshes.size(), 0) {
    for (const Instance& instance : scene.instances) ++users_[instance.mesh];
  }

  Mesh& of(uint32_t index) {
    Instance& instance = scene_.instances[index];
    if (users_[instance.mesh] > 1) {
      --users_[instance.mesh];
      const Mesh copy = scene_.meshes[instance.mesh];
      instance.mesh = static_cast<uint32_t>(scene_.meshes.size());
      scene_.meshes.push_back(copy);
      users_.push_back(1);
    }
    return scene_.meshes[instance.mesh];
  }

 private:
  Scene& scene_;
  std::vector<int> users_;
};

// Sets the depths of sheets, so that light that passes through one face starts behind the others.
void set_depths(Scene& scene, const std::vector<Pair>& pairs, const std::map<Face, int>& levels,
                double size_m) {
  for (const Pair& pair : pairs) {
    if (pair.relation == Relation::parted) continue;
    const int front = levels.at(pair.front), behind = levels.at(pair.behind);
    const int steps = pair.opposite ? front + behind : front - behind;
    const double depth_m = (std::abs(steps) * step + tolerance) * size_m;
    for (const Face& face : {pair.front, pair.behind}) {
      double& of_part_m = scene.instances[face.instance].sheet_depth_m;
      of_part_m = std::max(of_part_m, depth_m);
    }
  }
}

void move_faces(Scene& scene, const std::map<Face, int>& levels, double step_m) {
  OwnMeshes meshes(scene);
  for (const auto& [face, level] : levels) {
    if (level == 0) continue;
    const PlacedFace at = *placed(scene, face);
    Mesh& mesh = meshes.of(face.instance);
    const Instance& instance = scene.instances[face.instance];
    const Vec3 by = instance.body_from_mesh.linear().inverse() * (level * step_m * at.normal);
    for (uint32_t& corner : mesh.triangles[face.triangle]) {
      const Vec3 moved = mesh.vertices_m[corner] + by;
      mesh.vertices_m.push_back(moved);
      if (!mesh.uv.empty()) mesh.uv.push_back(Vec2(mesh.uv[corner]));
      corner = static_cast<uint32_t>(mesh.vertices_m.size() - 1);
    }
  }
}

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

// Cuts faces along their lines of intersection. The pieces then touch there.
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
         {std::pair(pair.front, pair.behind), std::pair(pair.behind, pair.front)}) {
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

std::vector<std::string> lines_about(const Scene& scene, const std::vector<Pair>& pairs) {
  constexpr size_t most_lines = 5;
  std::map<std::tuple<bool, uint32_t, uint32_t>, std::set<Face>> by_parts;
  for (const Pair& pair : pairs) {
    if (pair.relation != Relation::coincident) continue;
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
      lines.push_back("coincident faces: " + std::to_string(most_first.size() - most_lines) +
                      " more pairs of parts");
      break;
    }
    const auto& [opposite, first, second] = parts;
    const std::string a = "\"" + scene.instances[first].path + "\"";
    const std::string b = "\"" + scene.instances[second].path + "\"";
    const std::string count = std::to_string(faces.size()) + " triangles of ";
    const std::string whose = a == b ? a : a + " and " + b;
    lines.push_back(
        count + whose +
        (opposite
             ? " coincide back to back and act as one sheet: each side has the optical "
               "properties of the face that is turned to it; transmitted light passes both"
             : " coincide and face the same way: light from the front meets only the first" +
                   (a == b ? std::string() : ", of " + a) + ", light from behind only the last" +
                   (a == b ? std::string() : ", of " + b) + "; transmitted light passes both"));
  }
  return lines;
}

}  // namespace

std::vector<std::string> separate_coincident_faces(Scene& scene) {
  const Eigen::AlignedBox3d box = scene.box();
  if (box.isEmpty()) return {};
  const double size_m = 0.5 * box.diagonal().norm();
  std::vector<Pair> pairs = find_pairs(scene, box.center(), size_m);
  if (cut_crossings(scene, pairs)) pairs = find_pairs(scene, box.center(), size_m);
  if (pairs.empty()) return {};
  std::vector<std::string> lines = lines_about(scene, pairs);
  const std::map<Face, int> levels = levels_of(pairs);
  set_depths(scene, pairs, levels, size_m);
  move_faces(scene, levels, step * size_m);
  return lines;
}

}  // namespace photorque
