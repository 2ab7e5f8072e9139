// What a surface does with light.
#pragma once

#include <memory>
#include <string>

#include "core/spectrum.h"

namespace photorque {

struct Bsdf;  // raytrace/surfaces/bsdf.h

// Fractions of the incident power, per wavelength band, the same for every angle of incidence:
//   absorbed    stays in the surface (no re-emission)
//   specular    leaves mirrored about the normal
//   diffuse     leaves on the side it came from, by Lambert's law
//   transmitted goes straight on (a thin sheet, no refraction)
// They are in [0, 1] and sum to 1 in every band. Rough, glazed, retroreflecting and re-emitting
// surfaces have a BSDF, which says more; their fractions here are those at normal incidence.
struct OpticalSurface {
  std::string name;
  BandValues absorbed{};
  BandValues specular{};
  BandValues diffuse{};
  BandValues transmitted{};
  std::shared_ptr<const Bsdf> bsdf = nullptr;
};

// The same fractions in all bands; `absorbed` is what remains. The caller keeps the sum ≤ 1.
OpticalSurface grey_surface(std::string name, double specular, double diffuse,
                            double transmitted = 0.0);

}  // namespace photorque
