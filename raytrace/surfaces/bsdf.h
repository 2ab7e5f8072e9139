// Scattering of light by a surface: its bidirectional scattering distribution function (BSDF).
//
// An AlbedoLaw divides the power between components, a Lobe between directions. Both see a hit in
// its own frame: z is the normal on the lit side and x lies in the plane of incidence, so that
// light comes from (sin θ, 0, cos θ) =: i and leaves along o. The scattering function is then
//   f(i, o) = Σ fraction(cos θ_i) · density(cos θ_i, o) / o_z        [1/sr]
// over the components that are not delta functions. A passive surface has f(i, o) = f(o, i).
//
// Every surface takes this way. A plain one has a constant albedo, a mirror as its specular and
// Lambert's law as its diffuse component, and needs no Bsdf for it.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "core/numerics/random.h"
#include "core/spectrum.h"
#include "core/transform.h"

namespace photorque {

struct Bsdf;

// Fractions of the incident power, per wavelength band, the same for every angle of incidence:
//   absorbed    stays in the surface (no re-emission)
//   specular    leaves mirrored about the normal
//   diffuse     leaves on the side it came from, by Lambert's law
//   transmitted goes straight on (a thin sheet, no refraction)
// They are in [0, 1] and sum to 1 in every band. Rough, glazed, retroreflecting and re-emitting
// surfaces have a BSDF, which is complete; their fractions here are those at normal incidence.
struct OpticalSurface {
  std::string name;
  BandValues absorbed{};
  BandValues specular{};
  BandValues diffuse{};
  BandValues transmitted{};
  std::shared_ptr<const Bsdf> bsdf = nullptr;
};

// A surface with equal fractions in all bands; the remainder is absorbed. The caller keeps the sum
// ≤ 1.
OpticalSurface grey_surface(std::string name, double specular, double diffuse,
                            double transmitted = 0.0);

// The components of a BSDF; light that is not absorbed goes on along one of them. Transmitted light
// goes straight on, retroreflected light goes back where it came from.
enum class Component : size_t { specular, diffuse, transmitted, retroreflected };
inline constexpr std::array components = {Component::specular, Component::diffuse,
                                          Component::transmitted, Component::retroreflected};

// Uniform random numbers in (0, 1) for one direction, and as many more as its method needs.
struct Draw {
  double u = 0.5, v = 0.5;  // well distributed from hit to hit
  uint64_t key = 0;         // of the hit

  double extra(uint64_t which) const { return unit_interval(hash_words(key, which)); }
  // The numbers for another try, where directions are drawn by rejection; 0 is the first.
  Draw attempt(uint64_t number) const {
    return number == 0 ? *this : Draw{extra(3 * number), extra(3 * number + 1), key};
  }
};

// Incidence of light on a surface, as input of a lobe.
struct Arrival {
  // NOLINTNEXTLINE(google-explicit-constructor): a cosine is all that most lobes use
  Arrival(double incidence_cosine, double cosine_of_axis = 1.0, double sine_of_axis = 0.0)
      : cosine(incidence_cosine), axis_cosine(cosine_of_axis), axis_sine(sine_of_axis) {}

  double cosine;                  // ∈ (0, 1], cos θ_i
  double axis_cosine, axis_sine;  // of Bsdf::axis along the surface, by its angle from x towards y
};

// The directions of one component's light. Immutable; called from many threads at once.
class Lobe {
 public:
  virtual ~Lobe() = default;

  // A unit direction with o_z > 0, distributed by density().
  virtual Vec3 direction(const Arrival& light, const Draw& draw) const = 0;

  // The expectation of direction(): times power over c, the momentum flow that leaves. From a
  // closed form, or a table that is made once.
  virtual Vec3 mean_direction(const Arrival& light) const = 0;

  // Per solid angle of o [1/sr]; integrates to 1 over the hemisphere.
  virtual double density(const Arrival& light, const Vec3& out) const = 0;
};

// Where the power of one band goes, in fractions that sum to 1.
struct PowerFractions {
  double absorbed = 0.0, specular = 0.0, diffuse = 0.0, transmitted = 0.0, retroreflected = 0.0;

  double of(Component component) const;
};

// Dependence of the fractions of a surface on the angle of incidence. Immutable; called from many
// threads at once.
class AlbedoLaw {
 public:
  virtual ~AlbedoLaw() = default;
  // `cosine` ∈ (0, 1] is cos θ_i; `band` is one that the surface was made for.
  virtual PowerFractions fractions(double cosine, size_t band) const = 0;
};

// Laws of a surface in addition to the fractions of an OpticalSurface; a null law changes nothing.
struct Bsdf {
  std::shared_ptr<const AlbedoLaw> law;  // null: the surface's fractions at every angle
  std::shared_ptr<const Lobe> specular;  // null: a mirror
  std::shared_ptr<const Lobe> diffuse;   // null: Lambert's law
  // The retroreflected fraction per band. With the surface's four fractions it sums to 1. Zero
  // where there is a law, which gives its own.
  BandValues retroreflected{};
  // The fraction of the absorbed power that leaves at once as heat radiation, by Lambert's law;
  // `front_emission` is the part of it that leaves the front. It counts in forces and torques only:
  // the power stays booked as absorbed.
  double reemitted = 0.0;
  double front_emission = 0.5;
  std::string description = {};  // a few words for notices
  // Body axes: the first axis of a lobe that is not the same all round the normal lies along this
  // vector's projection onto the surface. Zero where all lobes are.
  Vec3 axis = Vec3::Zero();
};

// Incidence of light on a surface, in any right-handed frame.
struct Incidence {
  // `direction` of the light, `normal` on the lit side, both of unit length.
  Incidence(const Vec3& direction, const Vec3& normal);

  Vec3 direction, normal;
  double cosine;  // of the angle of incidence, in [1e-9, 1]
};

// The fractions of one band at `cosine` ∈ (0, 1] of the angle of incidence.
PowerFractions fractions_of(const OpticalSurface& surface, double cosine, size_t band);

// Where light of one component goes: a unit vector in the frame of `incidence`.
Vec3 scattered_direction(const OpticalSurface& surface, Component component,
                         const Incidence& incidence, const Draw& draw);

// `power` times the expectation of scattered_direction(): over c, the momentum flow that leaves
// along the component.
Vec3 mean_flow(const OpticalSurface& surface, Component component, const Incidence& incidence,
               double power);

// Lambert's law about z: uniform in projected solid angle. `u`, `v` ∈ (0, 1).
Vec3 lambertian_direction(double u, double v);
// The mean of its z: light that leaves by Lambert's law pushes with 2/3 of its power over c along
// the normal.
// Source: F. L. Markley and J. L. Crassidis, Fundamentals of Spacecraft Attitude Determination and
// Control (2014), section 3.3.6.
inline constexpr double lambertian_mean = 2.0 / 3.0;

}  // namespace photorque
