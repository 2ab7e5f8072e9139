// Keys that several kinds of source share, and functions that read them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "core/spectrum.h"
#include "core/transform.h"
#include "sources/lamps/kind.h"
#include "sources/profiles/angular_profile.h"

namespace photorque {

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

// One lamp of power `power_W`, from the keys above, aperture_diameter_m, and optionally for the
// etendue die_size_m (side of a square) or die_diameter_m, with lens_index (default 1, a bare die).
struct Lamp {
  std::shared_ptr<const Emitter> emitter;
  Spectrum spectrum;
  UniformAperture aperture;
};
Lamp read_lamp(const Settings& settings, const SourceContext& context, const std::string& name,
               double power_W);

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

}  // namespace photorque
