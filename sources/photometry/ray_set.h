// Rays as measured at a lamp or exported by an optics program, and the files that hold them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/transform.h"

namespace photorque {

struct RaySet {
  struct Ray {
    Vec3 origin_m;
    Vec3 direction;             // of unit norm to 1e-3, as the file has it
    double flux = 0.0;          // ≥ 0, in `flux_unit` but of any scale, see the stated flux
    double wavelength_m = 0.0;  // 0: not stated for this ray
  };
  enum class FluxUnit { watt, lumen };

  std::string format;  // "TM-25-13", "Zemax", "LightTools"
  std::string name;    // name of the lamp in the file, may be empty
  FluxUnit flux_unit = FluxUnit::watt;
  std::optional<double> stated_radiant_flux_W;
  std::optional<double> stated_luminous_flux_lm;
  std::optional<double> wavelength_m;  // of all rays, where the file states one
  std::vector<Ray> rays;               // at least one; their flux sums to more than zero

  double ray_flux() const;  // the sum, in the unit and scale of the rays
};

// Each reader takes the bytes of a file and how messages call it. Sizes are checked against the
// bytes before anything is allocated. InputError for a file that is of another type, truncated, or
// holds a ray without direction, with a negative flux or with a number that is not finite.

// IES TM-25-13 (.tm25ray). Polarisation and colour of single rays are passed over.
RaySet read_tm25(const std::string& bytes, const std::string& name);

// Zemax binary source file (.dat, .sdf), flux only or with wavelengths.
RaySet read_zemax_rays(const std::string& bytes, const std::string& name);

// LightTools ray data file in text (.ray).
RaySet read_lighttools_rays(const std::string& bytes, const std::string& name);

// Whichever of them the bytes are.
RaySet read_rays(const std::string& bytes, const std::string& name);

// The bytes of a TM-25-13 file. Numbers are rounded to single precision, as the format has them;
// the result of read_tm25() comes back unchanged.
std::string write_tm25(const RaySet& set);

// Checks that the readers share:

// Throws InputError unless ray `index` has finite numbers, a start within largest_extent_m, a
// direction of length one (to 1e-3) and no negative flux.
void require_sound(const RaySet::Ray& ray, size_t index, const InputLocation& where);

// Throws InputError for a set without rays or without flux.
void require_flux(const RaySet& set, const InputLocation& where);

// Throws InputError for more rays than the file has room for, or than fit in memory kept for them.
void require_affordable(uint64_t rays, uint64_t room_for, const InputLocation& where);

}  // namespace photorque
