#include "scenes/gltf/coincident.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include "core/numerics/connected.h"
#include "core/text/format.h"
#include "scenes/gltf/overlaps.h"

namespace photorque {
namespace {

constexpr double step = 2e-6;    // fractions of the scene's size
constexpr double thin = 1e-6;    // the faces of one sheet are not farther apart
constexpr double nearly = 1e-4;  // faces that cross within this distance were meant to coincide

// Whether faces are apart by more than `least_m`, rather than in one plane except for the rounding
// of their corners, which changes from corner to corner.
bool apart(double low_m, double high_m, double least_m) {
  return std::abs(low_m + high_m) > 4.0 * (high_m - low_m) + 2.0 * least_m;
}

enum class Kind {
  stacked,       // equal orientation; `front` is in front of `behind`
  back_to_back,  // one sheet; the order has no meaning
  facing,        // the fronts face each other, with a gap between them
};

// The way in which two faces are separated.
struct Contact {
  Face front, behind;
  Kind kind;
  bool coincident;
  bool one_sheet;        // transmitted light passes both faces at once
  double gap_m, most_m;  // minimum and maximum distance of the faces, in the right order positive
};

// Decides the order of faces. It is the same for all faces of two parts in one patch, which is a
// set of faces that overlap each other directly or through others.
class Order {
 public:
  Order(const Scene& scene, Parts& parts, const std::vector<Pair>& pairs, double size_m)
      : parts_(parts), size_m_(size_m) {
    for (const Pair& pair : pairs) {
      number_.emplace(pair.one, number_.size());
      number_.emplace(pair.other, number_.size());
    }
    patches_ = DisjointSets(number_.size());
    for (const Pair& pair : pairs) {
      if (pair.relation == Relation::coincident) {
        patches_.join(number_.at(pair.one), number_.at(pair.other));
        if (!parts.transmits(pair.one.instance)) on_opaque_.insert(pair.other);
        if (!parts.transmits(pair.other.instance)) on_opaque_.insert(pair.one);
      }
    }
    for (const Pair& pair : pairs) {
      if (!of_two_parts(pair)) continue;
      Heights& all = heights_m_.try_emplace(key(pair), Heights{INFINITY, -INFINITY}).first->second;
      all = {std::min(all.low, pair.low_m), std::max(all.high, pair.high_m)};
    }
    for (const auto& [face, number] : number_) {
      const auto [a, b, c] = placed(scene, face)->corner_m;
      area_m2_[{patches_.root(number), face.instance}] += 0.5 * (b - a).cross(c - a).norm();
    }
  }

  Contact contact(const Pair& pair) {
    const auto [low_m, high_m] =
        of_two_parts(pair) ? heights_m_.at(key(pair)) : Heights{pair.low_m, pair.high_m};
    const bool coincident = pair.relation == Relation::coincident;
    const bool both_transmit =
        parts_.transmits(pair.one.instance) && parts_.transmits(pair.other.instance);
    const bool solids = parts_.solids(pair.one.instance, pair.other.instance);
    // An opaque face lies between transparent ones that are turned to its two sides.
    const bool parted = on_opaque_.contains(pair.one) || on_opaque_.contains(pair.other);
    const bool one_sheet = coincident && both_transmit && !(pair.opposite && (solids || parted)) &&
                           !apart(low_m, high_m, thin * size_m_);
    if (!pair.opposite) {
      const bool other_first = is_other_first(pair, low_m, high_m);
      if (other_first)
        return {pair.other, pair.one, Kind::stacked, coincident, one_sheet, low_m, high_m};
      return {pair.one, pair.other, Kind::stacked, coincident, one_sheet, -high_m, -low_m};
    }
    const bool above = low_m + high_m > 0.0;
    const bool facing = coincident ? (solids && pair.one.instance != pair.other.instance) ||
                                         (above && apart(low_m, high_m, thin * size_m_))
                                   : above;
    if (facing) return {pair.one, pair.other, Kind::facing, false, false, low_m, high_m};
    return {pair.one, pair.other, Kind::back_to_back, coincident, one_sheet, -high_m, -low_m};
  }

 private:
  struct Heights {
    double low, high;
  };
  using Key = std::tuple<size_t, uint32_t, uint32_t, bool>;

  static bool of_two_parts(const Pair& pair) {
    return pair.relation == Relation::coincident && pair.one.instance != pair.other.instance;
  }
  size_t patch(const Face& face) { return patches_.root(number_.at(face)); }
  Key key(const Pair& pair) {
    return {patch(pair.one), pair.one.instance, pair.other.instance, pair.opposite};
  }

  // The outer face is first; if they are in one plane, an open sheet before a solid, a transparent
  // face before an opaque one, the smaller part of the patch, the first in the file.
  bool is_other_first(const Pair& pair, double low_m, double high_m) {
    const uint32_t one = pair.one.instance, other = pair.other.instance;
    if (pair.relation != Relation::coincident || apart(low_m, high_m, single_rounding * size_m_)) {
      return low_m + high_m > 0.0;
    }
    if (one == other) return false;
    const bool solid = parts_.inward(one).has_value(),
               other_solid = parts_.inward(other).has_value();
    if (solid != other_solid) return solid;
    if (parts_.transmits(one) != parts_.transmits(other)) return parts_.transmits(other);
    constexpr double smaller = 0.99;
    const size_t at = patch(pair.one);
    return area_m2_.at({at, other}) < smaller * area_m2_.at({at, one});
  }

  Parts& parts_;
  double size_m_;
  std::map<Face, size_t> number_;
  std::set<Face> on_opaque_;  // faces that coincide with an opaque one
  DisjointSets patches_{0};
  std::map<Key, Heights> heights_m_;
  std::map<std::pair<size_t, uint32_t>, double> area_m2_;  // by patch and part
};

// Distance [m] by which each face is displaced along its normal: as little as the contacts need. Of
// faces back to back both move forwards, of stacked faces the front one. Faces that face each other
// move backwards.
std::map<Face, double> offsets_of(const Scene& scene, const std::vector<Contact>& contacts,
                                  double size_m) {
  constexpr int most = 100;  // limit for a contradictory order of faces
  // Light that passes through one of the faces, as part of a sheet, starts in front of the other.
  const auto needed_m = [&](const Contact& contact) {
    const double depth_m = contact.one_sheet
                               ? 0.0
                               : std::max(scene.instances[contact.front.instance].sheet_depth_m,
                                          scene.instances[contact.behind.instance].sheet_depth_m);
    const double least_m = contact.coincident ? -INFINITY : -coincidence_tolerance * size_m;
    return step * size_m + depth_m - std::max(contact.gap_m, least_m);
  };
  std::map<Face, double> offset_m;
  for (const Contact& contact : contacts) {
    if (contact.kind == Kind::facing) continue;
    for (const Face& face : {contact.front, contact.behind}) {
      double& at_m = offset_m[face];
      if (contact.kind != Kind::back_to_back) continue;
      at_m = std::max(at_m, 0.5 * (needed_m(contact) + step * size_m));
    }
  }
  bool changed = true;
  for (int pass = 0; changed && pass < most; ++pass) {
    changed = false;
    for (const Contact& contact : contacts) {
      if (contact.kind != Kind::stacked) continue;
      double& at_m = offset_m[contact.front];
      const double least_m = offset_m[contact.behind] + needed_m(contact);
      changed = changed || at_m < least_m;
      at_m = std::max(at_m, least_m);
    }
  }
  for (const Contact& contact : contacts) {
    if (contact.kind != Kind::facing) continue;
    double &one_m = offset_m[contact.front], &other_m = offset_m[contact.behind];
    const double needed = needed_m(contact);
    if (one_m + other_m <= -needed) continue;
    if (one_m <= 0.0) {
      one_m = -other_m - needed;
    } else if (other_m <= 0.0) {
      other_m = -one_m - needed;
    }
  }
  return offset_m;
}

// Sets the depths of sheets, so that light that passes through one face starts behind the others.
// Returns whether a depth has grown.
bool deepen(Scene& scene, const std::vector<Contact>& contacts,
            const std::map<Face, double>& offset_m, double size_m) {
  bool grown = false;
  for (const Contact& contact : contacts) {
    if (!contact.one_sheet) continue;
    const double front_m = offset_m.at(contact.front), behind_m = offset_m.at(contact.behind);
    const double apart_m = contact.kind == Kind::stacked ? front_m - behind_m : front_m + behind_m;
    const double depth_m = apart_m + std::max(contact.most_m, 0.0) + thin * size_m;
    for (const Face& face : {contact.front, contact.behind}) {
      double& of_part_m = scene.instances[face.instance].sheet_depth_m;
      if (depth_m <= of_part_m) continue;
      of_part_m = depth_m;
      grown = true;
    }
  }
  return grown;
}

void move_faces(Scene& scene, const std::map<Face, double>& offset_m) {
  OwnMeshes meshes(scene);
  for (const auto& [face, by_m] : offset_m) {
    if (by_m == 0.0) continue;
    const PlacedFace at = *placed(scene, face);
    Mesh& mesh = meshes.of(face.instance);
    const Instance& instance = scene.instances[face.instance];
    const Vec3 by = instance.body_from_mesh.linear().inverse() * (by_m * at.normal);
    for (uint32_t& corner : mesh.triangles[face.triangle]) {
      const Vec3 moved = mesh.vertices_m[corner] + by;
      mesh.vertices_m.push_back(moved);
      if (!mesh.uv.empty()) mesh.uv.push_back(Vec2(mesh.uv[corner]));
      corner = static_cast<uint32_t>(mesh.vertices_m.size() - 1);
    }
  }
}

std::string named(const Scene& scene, uint32_t part) {
  return "\"" + scene.instances[part].path + "\"";
}

std::vector<std::string> lines_about(const Scene& scene, Parts& parts,
                                     const std::vector<Contact>& contacts) {
  constexpr size_t most_lines = 5;
  std::map<std::tuple<bool, uint32_t, uint32_t>, std::set<Face>> by_parts;
  for (const Contact& contact : contacts) {
    if (!contact.coincident) continue;
    auto& faces = by_parts[{contact.kind == Kind::back_to_back, contact.front.instance,
                            contact.behind.instance}];
    faces.insert({contact.front, contact.behind});
  }
  using Entry = std::pair<std::tuple<bool, uint32_t, uint32_t>, std::set<Face>>;
  std::vector<Entry> most_first(by_parts.begin(), by_parts.end());
  std::ranges::stable_sort(most_first, std::greater<>(),
                           [](const Entry& entry) { return entry.second.size(); });
  std::vector<std::string> lines;
  for (const auto& [whose, faces] : most_first) {
    if (lines.size() == most_lines) {
      lines.push_back("coincident faces: " + std::to_string(most_first.size() - most_lines) +
                      " more pairs of parts");
      break;
    }
    const auto& [opposite, first, second] = whose;
    const std::string a = named(scene, first), b = named(scene, second);
    const bool any = parts.transmits(first) || parts.transmits(second);
    const bool all = parts.transmits(first) && parts.transmits(second);
    lines.push_back(
        std::to_string(faces.size()) + " triangles of " + (a == b ? a : a + " and " + b) +
        (opposite
             ? " coincide back to back and act as one sheet: each side has the optical "
               "properties of the face that is turned to it"
             : " coincide and face the same way: light from the front meets only the first" +
                   (a == b ? std::string() : ", of " + a) + ", light from behind only the last" +
                   (a == b ? std::string() : ", of " + b)) +
        (all   ? "; transmitted light passes both"
         : any ? "; light that the transparent one transmits meets the other"
               : ""));
  }
  return lines;
}

// Parts whose faces cross each other at small heights, too far to count as coincident.
std::vector<std::string> lines_about_crossings(const Scene& scene, const std::vector<Pair>& pairs,
                                               double size_m) {
  constexpr size_t most_lines = 3;
  std::map<std::pair<uint32_t, uint32_t>, double> height_m;
  for (const Pair& pair : pairs) {
    const double most_m = std::max(-pair.low_m, pair.high_m);
    if (pair.relation != Relation::crossing || most_m > nearly * size_m) continue;
    if (pair.one.instance == pair.other.instance) continue;
    double& of_parts_m = height_m[{pair.one.instance, pair.other.instance}];
    of_parts_m = std::max(of_parts_m, most_m);
  }
  std::vector<std::string> lines;
  for (const auto& [whose, most_m] : height_m) {
    if (lines.size() == most_lines) break;
    lines.push_back(
        "faces of " + named(scene, whose.first) + " and " + named(scene, whose.second) +
        printed(" cross each other within %.2g m, more than the %.2g m within which faces count as "
                "coincident: light meets some places of each. Write their corners with more "
                "digits, or move them apart",
                most_m, coincidence_tolerance * size_m));
  }
  return lines;
}

}  // namespace

std::vector<std::string> separate_coincident_faces(Scene& scene) {
  const double extent_m = size_m(scene);
  Parts parts(scene);
  std::vector<Pair> pairs = find_pairs(scene, parts);
  const std::vector<std::string> crossings = lines_about_crossings(scene, pairs, extent_m);
  if (cut_crossings(scene, pairs)) pairs = find_pairs(scene, parts);
  if (pairs.empty()) return {};
  Order order(scene, parts, pairs, extent_m);
  std::vector<Contact> contacts;
  for (const Pair& pair : pairs) contacts.push_back(order.contact(pair));
  std::map<Face, double> offset_m;
  constexpr int most = 10;
  for (int round = 0; round < most; ++round) {
    offset_m = offsets_of(scene, contacts, extent_m);
    if (!deepen(scene, contacts, offset_m, extent_m)) break;
  }
  std::vector<std::string> lines = lines_about(scene, parts, contacts);
  lines.insert(lines.end(), crossings.begin(), crossings.end());
  move_faces(scene, offset_m);
  return lines;
}

}  // namespace photorque
