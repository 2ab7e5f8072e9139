#include "sources/photometry/ray_set.h"

#include <cmath>

#include "core/constants.h"
#include "core/text/parse.h"

namespace photorque {

double RaySet::ray_flux() const {
  double sum = 0.0;
  for (const Ray& ray : rays) sum += ray.flux;
  return sum;
}

void require_sound(const RaySet::Ray& ray, size_t index, const InputLocation& where) {
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw InputError(where, "ray " + std::to_string(index), found, expected);
  };
  if (!ray.origin_m.allFinite() || !ray.direction.allFinite()) {
    fail("a number that is not finite", "a position and a direction");
  }
  if (!(ray.origin_m.cwiseAbs().maxCoeff() <= largest_extent_m)) {
    fail("a start " + shortest(ray.origin_m.cwiseAbs().maxCoeff()) + " m away", "at most 1e9 m");
  }
  constexpr double tolerance = 1e-3;
  if (!(std::abs(ray.direction.norm() - 1.0) <= tolerance)) {
    fail("a direction of length " + std::to_string(ray.direction.norm()), "a unit vector");
  }
  if (!std::isfinite(ray.flux) || ray.flux < 0.0) {
    fail("a flux of " + std::to_string(ray.flux), "a number >= 0");
  }
}

void require_flux(const RaySet& set, const InputLocation& where) {
  if (set.rays.empty()) throw InputError(where, "rays", "none", "at least one ray");
  constexpr double least = 1e-60, most = 1e60;
  if (!(set.ray_flux() >= least && set.ray_flux() <= most)) {
    throw InputError(where, "flux", "rays whose flux sums to " + shortest(set.ray_flux()),
                     "some light, from 1e-60 to 1e60");
  }
}

void require_affordable(uint64_t rays, uint64_t room_for, const InputLocation& where) {
  if (rays > room_for) {
    throw InputError(where, "number of rays", std::to_string(rays),
                     "at most the " + std::to_string(room_for) + " that the file has room for");
  }
  constexpr uint64_t most = 50'000'000;
  if (rays <= most) return;
  throw InputError(where, "number of rays", std::to_string(rays),
                   "at most " + std::to_string(most));
}

RaySet read_rays(const std::string& bytes, const std::string& name) {
  if (bytes.starts_with("TM25")) return read_tm25(bytes, name);
  const std::string zemax_magic{'\xf2', '\x03', '\0', '\0'};  // 1010, little-endian
  if (bytes.starts_with(zemax_magic)) return read_zemax_rays(bytes, name);
  if (bytes.substr(0, 4096).find("lt_") != std::string::npos) {
    return read_lighttools_rays(bytes, name);
  }
  throw InputError({name}, "", "a file of no known kind",
                   "an IES TM-25, Zemax binary or LightTools text ray file");
}

}  // namespace photorque
