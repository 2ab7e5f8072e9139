// Pairs of faces of a scene that overlap nearly in one plane.
//
// Their search compares only faces with a common key: cells of the plane's normal and distance.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "raytrace/scene.h"

namespace photorque {

// Fractions of the scene's size, which is half the diagonal of its box. Six decimal digits round
// the corners of a face by up to 5e-6, and the distance of two faces by up to 3.5 times as much.
inline constexpr double coincidence_tolerance = 3e-5;
inline constexpr double single_rounding = 1e-7;  // of corners in single precision

struct Face {
  uint32_t instance, triangle;
  auto operator<=>(const Face&) const = default;
};

struct PlacedFace {
  Face face;
  std::array<Vec3, 3> corner_m;
  Vec3 normal, low_m, high_m;
};

// Relative position of two overlapping faces.
enum class Relation {
  coincident,  // within the tolerance over the whole overlap
  touching,    // within the tolerance at one end
  crossing,
};

// Two faces, `one` before `other` in the order of the file. Heights over the overlap: of `other`
// above the front of `one` if both face alike. If they face opposite ways, a positive height means
// that their fronts face each other.
struct Pair {
  Face one, other;
  bool opposite;
  Relation relation;
  double low_m, high_m;
};

// Half the diagonal of the scene's box; 0 for an empty scene.
double size_m(const Scene& scene);

// The face in the body frame; empty if it has no area.
std::optional<PlacedFace> placed(const Scene& scene, const Face& face);

// Properties of the parts that decide how their faces are separated.
class Parts {
 public:
  explicit Parts(const Scene& scene) : scene_(scene) {}

  // Result of fronts_look_inwards().
  std::optional<bool> inward(uint32_t part);
  // Whether either side transmits light.
  bool transmits(uint32_t part) const { return scene_.transmits(scene_.instances[part]); }
  // Whether both are closed with their fronts on the same side. A solid and its lining are not.
  bool solids(uint32_t a, uint32_t b) { return inward(a) && inward(a) == inward(b); }

 private:
  const Scene& scene_;
  std::map<uint32_t, std::optional<bool>> inward_;
};

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

// All pairs of faces that are within the tolerance somewhere in their overlap, each once. Faces of
// one solid and of opaque solids that touch are left out: no light gets between them.
std::vector<Pair> find_pairs(const Scene& scene, Parts& parts);

// Cuts the faces of crossing pairs along their lines of intersection. The pieces then touch there.
// Returns whether there were any.
bool cut_crossings(Scene& scene, const std::vector<Pair>& pairs);

}  // namespace photorque
