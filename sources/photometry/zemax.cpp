// Zemax OpticStudio binary source file: a header of 208 bytes and 7 or 8 numbers per ray.
// Source: Zemax OpticStudio User Manual, "Source File".
#include <array>
#include <cmath>

#include "core/little_endian.h"
#include "sources/photometry/ray_set.h"

namespace photorque {
namespace {

constexpr int32_t magic = 1010;
constexpr double micrometre = 1e-6;

// Metres per unit for the dimension units 0 to 4.
constexpr std::array<double, 5> unit_m = {1.0, 0.0254, 0.01, 0.3048, 0.001};

struct ZemaxHeader {
  uint32_t rays = 0;
  double metres_per_unit = 1.0;
  bool spectral = false;
};

ZemaxHeader read_zemax_header(LittleEndianReader& in, RaySet& set) {
  const int32_t found = in.int32("magic");
  if (found != magic) throw InputError(in.where(), "magic", std::to_string(found), "1010");
  ZemaxHeader header;
  header.rays = in.unsigned_integer<uint32_t>("number of rays");
  const std::string_view name = in.take(100, "description");
  set.name = std::string(name.substr(0, name.find('\0')));
  const float source_flux = in.float32("source flux");
  in.float32("flux of the ray set");
  const float wavelength_um = in.float32("wavelength");
  in.skip(16, "ranges of angles");
  const uint32_t unit = in.unsigned_integer<uint32_t>("dimension units");
  if (unit >= unit_m.size()) {
    throw InputError(in.where(), "dimension units", std::to_string(unit), "0 to 4");
  }
  header.metres_per_unit = unit_m[unit];
  in.skip(36 + 16, "placement");
  const int32_t format = in.int32("ray format");
  if (format != 0 && format != 2) {
    throw InputError(in.where(), "ray format", std::to_string(format),
                     "0 (flux only) or 2 (spectral)");
  }
  header.spectral = format == 2;
  const int32_t flux_kind = in.int32("flux type");
  if (flux_kind != 0 && flux_kind != 1) {
    throw InputError(in.where(), "flux type", std::to_string(flux_kind), "0 (watt) or 1 (lumen)");
  }
  in.skip(8, "reserved bytes");
  set.flux_unit = flux_kind == 0 ? RaySet::FluxUnit::watt : RaySet::FluxUnit::lumen;
  if (source_flux > 0.0f && std::isfinite(source_flux)) {
    (flux_kind == 0 ? set.stated_radiant_flux_W : set.stated_luminous_flux_lm) = source_flux;
  }
  if (!header.spectral && wavelength_um > 0.0f && std::isfinite(wavelength_um)) {
    set.wavelength_m = micrometre * wavelength_um;
  }
  return header;
}

}  // namespace

RaySet read_zemax_rays(const std::string& bytes, const std::string& name) {
  LittleEndianReader in(bytes, name);
  RaySet set;
  set.format = "Zemax";
  const ZemaxHeader header = read_zemax_header(in, set);
  const uint64_t there = in.left() / (header.spectral ? 32 : 28);
  require_affordable(header.rays, there, {name});
  set.rays.reserve(header.rays);
  for (uint32_t i = 0; i < header.rays; ++i) {
    RaySet::Ray ray;
    for (int k = 0; k < 3; ++k) ray.origin_m[k] = header.metres_per_unit * in.float32("rays");
    for (int k = 0; k < 3; ++k) ray.direction[k] = in.float32("rays");
    ray.flux = in.float32("rays");
    if (header.spectral) ray.wavelength_m = micrometre * in.float32("rays");
    if (!(ray.wavelength_m >= 0.0 && std::isfinite(ray.wavelength_m))) {
      throw InputError({name}, "ray " + std::to_string(i), "an invalid wavelength",
                       "a number >= 0");
    }
    require_sound(ray, i, {name});
    set.rays.push_back(ray);
  }
  require_flux(set, {name});
  return set;
}

}  // namespace photorque
