// Scattering of light by a surface: its bidirectional scattering distribution function (BSDF).
//
// An AlbedoLaw divides the power between components, a Lobe between directions. Both use the frame
// of the hit: z is the normal on the lit side and x lies in the plane of incidence. Light comes
// from i = (sin θ, 0, cos θ) and leaves along o. The scattering function is
//   f(i, o) = Σ fraction(cos θ_i) · density(cos θ_i, o) / o_z        [1/sr]
// over the components that are not delta functions. A passive surface has f(i, o) = f(o, i).
//
// All surfaces use this description. A plain surface has a constant albedo, a mirror as specular
// and Lambert's law as diffuse component; it has no Bsdf.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "core/numerics/random.h"
#include "core/spectrum.h"
#include "core/transform.h"

namespace photorque {

struct Bsdf;

// Fractions of the incident power per wavelength band, equal at every angle of incidence:
//   absorbed    stays in the surface (no re-emission)
//   specular    is reflected about the normal
//   diffuse     leaves on the side it came from, by Lambert's law
//   transmitted continues in its direction (a thin sheet without refraction)
// They are in [0, 1] and sum to 1 in every band. Rough, glazed, retroreflecting and re-emitting
// surfaces have a complete BSDF; their fractions here are those at normal incidence.
struct OpticalSurface {
  std::string name;
  BandValues absorbed{};
  BandValues specular{};
  BandValues diffuse{};
  BandValues transmitted{};
  std::shared_ptr<const Bsdf> bsdf = nullptr;
};

// Whether a fraction is positive in some band.
bool any_positive(const BandValues& fractions);

// A surface with equal fractions in all bands; the remainder is absorbed. The sum of the fractions
// must be ≤ 1.
OpticalSurface grey_surface(std::string name, double specular, double diffuse,
                            double transmitted = 0.0);

// Components of a BSDF; light that is not absorbed continues along one of them. Transmitted light
// keeps its direction; retroreflected light returns towards its origin.
enum class Component : size_t { specular, diffuse, transmitted, retroreflected };
inline constexpr std::array components = {Component::specular, Component::diffuse,
                                          Component::transmitted, Component::retroreflected};

// Uniform random numbers in (0, 1) for one direction, and further ones for methods that need them.
struct Draw {
  double u = 0.5, v = 0.5;  // well distributed from hit to hit
  uint64_t key = 0;         // of the hit

  double extra(uint64_t which) const { return unit_interval(hash_words(key, which)); }
  // Numbers for another attempt, for directions drawn by rejection; attempt 0 uses this draw.
  Draw attempt(uint64_t number) const {
    return number == 0 ? *this : Draw{extra(3 * number), extra(3 * number + 1), key};
  }
};

// Incidence of light on a surface, as input of a lobe.
struct Arrival {
  // NOLINTNEXTLINE(google-explicit-constructor): a cosine is all that most lobes use
  Arrival(double incidence_cosine, double cosine_of_axis = 1.0, double sine_of_axis = 0.0)
      : cosine(incidence_cosine), axis_cosine(cosine_of_axis), axis_sine(sine_of_axis) {}

  double cosine;  // cos θ_i ∈ (0, 1]
  // direction of Bsdf::axis on the surface, by its angle from x towards y
  double axis_cosine, axis_sine;
};

// Directional distribution of one component's light. Immutable; called from many threads at once.
class Lobe {
 public:
  virtual ~Lobe() = default;

  // Draws a unit direction with o_z > 0, distributed by density().
  virtual Vec3 direction(const Arrival& light, const Draw& draw) const = 0;

  // Expectation of direction(). Multiplied by power/c it is the leaving momentum flow. From a
  // closed form, or from a table that is computed once.
  virtual Vec3 mean_direction(const Arrival& light) const = 0;

  // Density per solid angle of o [1/sr]; integrates to 1 over the hemisphere.
  virtual double density(const Arrival& light, const Vec3& out) const = 0;
};

// Fractions of the power of one band; they sum to 1.
struct PowerFractions {
  double absorbed = 0.0, specular = 0.0, diffuse = 0.0, transmitted = 0.0, retroreflected = 0.0;

  // The fraction of a component.
  double of(Component component) const;
};

// Dependence of the fractions of a surface on the angle of incidence. Immutable; called from many
// threads at once.
class AlbedoLaw {
 public:
  virtual ~AlbedoLaw() = default;
  // `cosine` ∈ (0, 1] is cos θ_i; `band` is one of the bands that the surface was created for.
  virtual PowerFractions fractions(double cosine, size_t band) const = 0;
};

// Scattering laws of a surface in addition to its constant fractions.
struct Bsdf {
  std::shared_ptr<const AlbedoLaw> law;  // null: the surface's fractions at every angle
  std::shared_ptr<const Lobe> specular;  // null: a mirror
  std::shared_ptr<const Lobe> diffuse;   // null: Lambert's law
  // Retroreflected fraction per band, for surfaces without a law: with the surface's four fractions
  // it sums to 1. A law states its own; then this is zero.
  BandValues retroreflected{};
  // Fraction of the absorbed power that leaves at once as heat radiation by Lambert's law;
  // `front_emission` is the part of it that leaves the front. It affects only forces and torques:
  // the power balance counts this power as absorbed.
  double reemitted = 0.0;
  double front_emission = 0.5;
  std::string description = {};  // short text for messages
  // Axis in the body frame. The first axis of a lobe without rotational symmetry about the normal
  // is the projection of this vector on the surface. Zero if all lobes are symmetric.
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

// Sets the fractions of one band.
void set_fractions(OpticalSurface& surface, size_t band, const PowerFractions& fractions);

// Draws the direction of light of one component: a unit vector in the frame of `incidence`.
Vec3 scattered_direction(const OpticalSurface& surface, Component component,
                         const Incidence& incidence, const Draw& draw);

// `power` times the expectation of scattered_direction(). Divided by c it is the momentum flow that
// leaves along the component.
Vec3 mean_flow(const OpticalSurface& surface, Component component, const Incidence& incidence,
               double power);

// Direction by Lambert's law about z: uniform in projected solid angle. `u`, `v` ∈ (0, 1).
Vec3 lambertian_direction(double u, double v);
// Mean of z over Lambert's law: light that leaves by it pushes along the normal with 2/3 of its
// power divided by c.
// Source: F. L. Markley and J. L. Crassidis, Fundamentals of Spacecraft Attitude Determination and
// Control (2014), section 3.3.6.
inline constexpr double lambertian_mean = 2.0 / 3.0;

}  // namespace photorque
