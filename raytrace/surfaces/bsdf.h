// What a surface does with light where a mirror, Lambert's law and the same fractions at every
// angle do not do.
//
// An AlbedoLaw says how much of the power goes where, a Lobe in which directions. Both see a hit in
// its own frame: z is the normal on the lit side and x lies in the plane of incidence, so that
// light comes from (sin θ, 0, cos θ) =: i and leaves along o. The scattering function is then
//   f(i, o) = Σ share(cos θ_i) · density(cos θ_i, o) / o_z        [1/sr]
// over the lobes that are no delta functions. A passive surface has f(i, o) = f(o, i).
#pragma once

#include <memory>
#include <string>

#include "core/numerics/random.h"
#include "core/vector.h"
#include "raytrace/surfaces/surface.h"

namespace photorque {

// Uniform random numbers in (0, 1) for one direction, and as many more as its method needs.
struct Draw {
  double u = 0.5, v = 0.5;  // well distributed from hit to hit
  uint64_t key = 0;         // of the hit

  double extra(uint64_t which) const { return unit_interval(hash_words(key, which)); }
  Draw attempt(uint64_t number) const {
    return number == 0 ? *this : Draw{extra(3 * number), extra(3 * number + 1), key};
  }
};

// Directions of reflected light. Immutable; called from many threads at once.
class Lobe {
 public:
  virtual ~Lobe() = default;

  // A unit direction with o_z > 0, distributed by density(). `cosine` ∈ (0, 1] is cos θ_i.
  virtual Vec3 direction(double cosine, const Draw& draw) const = 0;

  // The expectation of direction(): times power over c, the momentum flow that leaves. From a
  // closed form, or a table that is made once.
  virtual Vec3 mean_direction(double cosine) const = 0;

  // Per solid angle of o [1/sr]; integrates to 1 over the hemisphere.
  virtual double density(double cosine, const Vec3& out) const = 0;
};

// Where the power of one band goes, in fractions that sum to 1.
struct PowerFractions {
  double absorbed = 0.0, specular = 0.0, diffuse = 0.0, transmitted = 0.0, retroreflected = 0.0;
};

class AlbedoLaw {
 public:
  virtual ~AlbedoLaw() = default;
  // `cosine` ∈ (0, 1] is cos θ_i.
  virtual PowerFractions fractions(double cosine, size_t band) const = 0;
};

// What a surface adds to the fractions of an OpticalSurface; what is null stays as it is there.
struct Bsdf {
  std::shared_ptr<const AlbedoLaw> law;  // null: the surface's fractions at every angle
  std::shared_ptr<const Lobe> specular;  // null: a mirror
  std::shared_ptr<const Lobe> diffuse;   // null: Lambert's law
  // Goes back where it came from. With the surface's four fractions it sums to 1. Not with a law.
  BandValues retroreflected{};
  // This fraction of the absorbed power leaves at once as heat radiation, by Lambert's law, of it
  // `front_emission` on the front. In forces and torques only: the power stays booked as absorbed.
  double reemitted = 0.0;
  double front_emission = 0.5;
  std::string description = {};  // a few words for notices
};

PowerFractions fractions_of(const OpticalSurface& surface, double cosine, size_t band);

// f(i, o) without delta functions (mirror, straight on, retroreflection).
double scattering_1_sr(const OpticalSurface& surface, double cosine, const Vec3& out, size_t band);

// The expected direction of everything that leaves, times its fraction of the power: for power P in
// `band` the momentum flow that leaves is P/c times this. Frame of the hit. Without heat radiation.
Vec3 first_moment(const OpticalSurface& surface, double cosine, size_t band);

// Lambert's law about z: uniform in projected solid angle.
Vec3 lambertian_direction(double u, double v);

}  // namespace photorque
