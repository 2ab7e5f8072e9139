// Keys that several kinds of source share, and functions that read them; a lamp behind a round
// aperture.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/constants.h"
#include "core/settings/typed_keys.h"
#include "core/spectrum.h"
#include "core/transform.h"
#include "sources/lamps/kind.h"
#include "sources/profiles/angular_profile.h"

namespace photorque {

// Lower limits of apertures and beam widths, below those of real optics. Far smaller values have
// squares that underflow or are smaller than the rounding errors of distances.
inline constexpr Range opening_diameter{1e-12, 1e308, false, false};
inline constexpr Range beam_width{1e-12 * degree_rad, pi, false, true};
inline constexpr Range beam_half_angle{1e-12 * degree_rad, 0.5 * pi, false, false};

inline constexpr double usual_led_width_m = 20e-9;  // default spectral_fwhm_nm of LEDs

namespace source_key {
inline constexpr TextKey name("name", "name in results and messages");  // default: the kind
inline constexpr NumberKey power("power_W", Range::positive(), "radiant power of each lamp");
// A kind may replace the description with its own meaning of the point.
inline constexpr Vec3Key position("position_m", "of the lamp, lab axes");
inline constexpr Vec3Key direction("direction",
                                   "direction of the beam, lab axes, any length; or `aim_m`",
                                   {.optional = true});
inline constexpr Vec3Key aim("aim_m", "instead of `direction`: a point on the axis of the beam",
                             {.optional = true});
inline constexpr NumberKey wavelength("wavelength_nm", {1e-8, 1e-3},
                                      "centre wavelength of the spectrum");
inline constexpr NumberKey spectral_fwhm(
    "spectral_fwhm_nm", usual_led_width_m, {0.0, 1e-3},
    "full width at half maximum of the Gaussian spectrum; 0: a single line");
inline constexpr NumberKey aperture_diameter("aperture_diameter_m", opening_diameter,
                                             "diameter of the emitting aperture");

// Direction of light from a distant source.
inline constexpr Vec3Key light_direction("direction",
                                         "direction of the light, lab axes, any length");
}  // namespace source_key

// Direction of a source, of any nonzero length: `direction`, a vector, or from `position_m` to the
// point `aim_m`. Throws InputError for both, for neither, or for zero length.
Vec3 read_direction(const Settings& settings, const Vec3& position_m);

// The vector of the key `direction`, of any nonzero length.
Vec3 read_direction_vector(const Settings& settings);

// Vector from one point to another that `key` names. Throws InputError if they coincide.
Vec3 direction_to(const Settings& settings, std::string_view key, const Vec3& from_m,
                  const Vec3& to_m);

// Angular distribution of a lamp from `profile` with its angles, and the halo.
AngularDistribution read_angular_distribution(const Settings& settings);

// Spectrum from wavelength_nm and spectral_fwhm_nm with a default.
Spectrum read_line_spectrum(const Settings& settings, double default_fwhm_m);

// Spectrum and irradiance [W/m²] of the Sun and of solar simulators.
struct Sunlight {
  Spectrum spectrum;
  double irradiance_W_m2;
};
Sunlight read_sunlight(const Settings& settings);
std::vector<Key> sunlight_keys();

// Light from a disc whose points all radiate alike: the position is uniform over the area, the
// direction is independent of the position. The disc lies at z = 0, directions are measured
// from +z.
class DiscLamp : public Emitter {
 public:
  // power > 0 and aperture diameter > 0; the caller checks this.
  DiscLamp(double power_W, double aperture_diameter_m, AngularDistribution directions);

  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override;
  double relative_intensity(double angle_rad) const override;

 private:
  double power_W_;
  double aperture_radius_m_;
  AngularDistribution directions_;
};

// The emitting area inside a lamp.
struct Die {
  double area_m2 = 0.0;
  double index = 1.0;  // refractive index around it: 1 for a bare die, 1.4–1.5 in a dome
};

// A notice if optics cannot produce the beam, with an aperture that would suffice. Lossless optics
// cannot make light brighter than its source: a Lambertian die in a medium of index n has the
// etendue π n² A. For a beam, aperture area × effective solid angle (flux over largest intensity)
// must be at least as large.
// Source: R. Winston, J. C. Miñano, P. Benítez, Nonimaging Optics (2005), chapter 2.
std::optional<std::string> etendue_notice(const std::string& name, const Die& die,
                                          double aperture_diameter_m,
                                          double effective_solid_angle_sr);

// One lamp of power `power_W`, from the keys above, aperture_diameter_m, and optionally for the
// etendue die_size_m (side of a square) or die_diameter_m, with lens_index (default 1, a bare die).
struct Lamp {
  std::shared_ptr<const Emitter> emitter;
  Spectrum spectrum;
  UniformAperture aperture;
};
Lamp read_lamp(const Settings& settings, const SourceContext& context, const std::string& name,
               double power_W);
std::vector<Key> lamp_keys();

// Name for messages and bytes of the file that the key `file` names, relative to the context's
// folder. The context receives its hash.
struct SourceFile {
  std::string name;
  std::string bytes;
};
SourceFile read_source_file(const Settings& settings, const SourceContext& context);

// Frame of a lamp whose beam, its z axis, points along `direction` (any length but zero). If that
// is straight down, x is the lab's x and y the lab's −y. For other directions this frame is rotated
// by the shortest rotation from straight down. It depends continuously on the direction except at
// straight up, where it is the lab's frame.
RigidTransform lamp_frame(const Vec3& direction, const Vec3& origin_m);

// One lamp at position_m called `name`, or equal lamps at each of positions_m called name[0],
// name[1], … Each points along `direction` or at aim_m, as in lamp_frame(), and is rotated by
// turn_deg (default 0) about its beam. `aperture` as in Beam.
std::vector<Beam> place_lamps(const Settings& settings, const std::string& name,
                              const std::shared_ptr<const Emitter>& lamp, const Spectrum& spectrum,
                              const std::optional<UniformAperture>& aperture = std::nullopt);
std::vector<Key> lamp_place_keys();

}  // namespace photorque
