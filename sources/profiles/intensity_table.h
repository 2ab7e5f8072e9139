// Intensity over directions as a goniometer measures it: a table of planes.
#pragma once

#include <cstddef>
#include <vector>

#include "core/transform.h"

namespace photorque {

// Spherical coordinates about a pole. Which way the pole points in the frame of an emitter (z along
// the beam, x and y across):
enum class Pole {
  beam,        // +z: type C of LM-63, C planes and γ of EULUMDAT
  vertical,    // +y: type A, latitude V and longitude H
  horizontal,  // +x: type B, latitude H and longitude V
};

// Intensity I(polar, azimuth) ≥ 0 of any one unit, at least one value > 0. Between the angles of a
// plane it is a monotone cubic (see monotone_slopes()), between planes linear in azimuth; outside
// the angles of the table there is no light.
struct IntensityTable {
  Pole pole = Pole::beam;
  std::vector<double> polar_rad;    // from the pole, strictly ascending in [0, π], at least two
  std::vector<double> azimuth_rad;  // of the planes, strictly ascending
  // The planes go all the way round: azimuths in [0, 2π), the last plane is a neighbour of the
  // first, and a single plane stands for every azimuth. Otherwise at least two planes, less than a
  // turn apart.
  bool closed = true;
  std::vector<double> intensity;  // [plane][polar]

  size_t planes() const { return azimuth_rad.size(); }
  const double* plane(size_t index) const { return &intensity[index * polar_rad.size()]; }
};

// The direction in the emitter's frame with these coordinates. For the pole `beam` the azimuth is
// the photometric C angle: seen from above a luminaire that shines down, C runs against the clock
// from the luminaire's x axis; in the emitter's frame, which looks along the light, it therefore
// runs from +x towards −y.
Vec3 table_direction(Pole pole, double polar_rad, double azimuth_rad);

struct GoniometerAngles {
  double polar_rad = 0.0;    // ∈ [0, π]
  double azimuth_rad = 0.0;  // ∈ (−π, π]
};
// The inverse, for a unit vector.
GoniometerAngles table_angles(Pole pole, const Vec3& direction);

}  // namespace photorque
