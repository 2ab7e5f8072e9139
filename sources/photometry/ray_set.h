// Rays that were measured at a lamp or exported by an optics program, and the files that contain
// them.
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
    Vec3 direction;             // of unit norm to 1e-3, as in the file
    double flux = 0.0;          // ≥ 0, in `flux_unit` up to a common factor, see the stated flux
    double wavelength_m = 0.0;  // 0: not stated for this ray
  };
  enum class FluxUnit { watt, lumen };

  std::string format;  // "TM-25-13", "Zemax", "LightTools"
  std::string name;    // name of the lamp in the file, may be empty
  FluxUnit flux_unit = FluxUnit::watt;
  std::optional<double> stated_radiant_flux_W;
  std::optional<double> stated_luminous_flux_lm;
  std::optional<double> wavelength_m;  // common to all rays, if the file states one
  std::vector<Ray> rays;               // at least one; their flux sums to more than zero

  double ray_flux() const;  // sum over the rays, in their unit and scale
};

// Each reader takes the bytes of a file and its name for messages. Sizes are checked against the
// number of bytes before memory is allocated. Throws InputError if the file has another type or is
// truncated, or if a ray has no direction, a negative flux or a non-finite number.

// IES TM-25-13 (.tm25ray). Polarisation and colour of single rays are ignored.
RaySet read_tm25(const std::string& bytes, const std::string& name);

// Zemax binary source file (.dat, .sdf), flux only or with wavelengths.
RaySet read_zemax_rays(const std::string& bytes, const std::string& name);

// LightTools ray data file in text (.ray).
RaySet read_lighttools_rays(const std::string& bytes, const std::string& name);

// Detects the format from the bytes and reads them.
RaySet read_rays(const std::string& bytes, const std::string& name);

// Bytes of a TM-25-13 file. Numbers are rounded to single precision, as the format requires; the
// result of read_tm25() is reproduced exactly.
std::string write_tm25(const RaySet& set);

// Checks shared by the readers.

// Throws InputError unless ray `index` has finite numbers, a start within largest_extent_m, a
// direction of length one (to 1e-3) and no negative flux.
void require_sound(const RaySet::Ray& ray, size_t index, const InputLocation& where);

// Throws InputError for a set without rays or without flux.
void require_flux(const RaySet& set, const InputLocation& where);

// Throws InputError for more rays than the file has room for, or than fit in memory.
void require_affordable(uint64_t rays, uint64_t room_for, const InputLocation& where);

}  // namespace photorque
