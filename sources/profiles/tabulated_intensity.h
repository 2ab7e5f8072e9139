// Intensity over directions as measured by a goniometer: a table of planes.
#pragma once

#include <cstddef>
#include <vector>

#include "core/transform.h"
#include "sources/profiles/sampling.h"

namespace photorque {

// Spherical coordinates about a pole, by the direction of the pole in the frame of an emitter (z
// along the beam, x and y across):
enum class Pole {
  beam,        // +z: type C of LM-63, C planes and γ of EULUMDAT
  vertical,    // +x: type A, latitude V and longitude H
  horizontal,  // +y: type B, latitude H and longitude V
};

// Intensity I(polar, azimuth) ≥ 0 in any unit, at least one value > 0. Interpolation is a monotone
// cubic between the angles of a plane (see monotone_slopes()), and linear in azimuth between
// planes. Outside the angles of the table the intensity is zero.
struct IntensityTable {
  Pole pole = Pole::beam;
  std::vector<double> polar_rad;    // from the pole, strictly ascending in [0, π], at least two
  std::vector<double> azimuth_rad;  // of the planes, strictly ascending
  // True: the planes cover the whole circle with azimuths in [0, 2π), the last plane is a neighbour
  // of the first, and a single plane is valid at every azimuth. False: at least two planes, less
  // than a turn apart.
  bool closed = true;
  std::vector<double> intensity;  // [plane][polar]

  size_t planes() const { return azimuth_rad.size(); }
  const double* plane(size_t index) const { return &intensity[index * polar_rad.size()]; }
};

struct GoniometerAngles {
  double polar_rad = 0.0;    // ∈ [0, π]
  double azimuth_rad = 0.0;  // ∈ (−π, π]
};
// Coordinates of a direction (unit vector) of the emitter's frame. For the pole `beam` the azimuth
// is the photometric C angle. Seen from above a luminaire that shines down, C runs
// counter-clockwise from the luminaire's x axis. In the emitter's frame, which looks along the
// light, it therefore runs from +x towards −y.
GoniometerAngles table_angles(Pole pole, const Vec3& direction);

// The interpolant of an intensity table: its value, its flux, and sampling of rays.
//
// Method. Every plane gets a knot half-way between any two of its angles (monotone_middle()) and is
// then a monotone cubic between knots. The table is a sum of planes, I = Σ_j hat_j(azimuth)
// I_j(polar), with hats that decrease linearly to zero at the neighbouring planes. A ray selects a
// plane by its fraction of the flux, an azimuth within the hat by inversion of a quadratic, and a
// polar angle with the plane's PlaneSampler.

class TabulatedIntensity {
 public:
  // The table must satisfy the conditions of IntensityTable; the caller checks this.
  explicit TabulatedIntensity(IntensityTable table);

  const IntensityTable& table() const { return table_; }

  // The interpolant, in the unit of the table.
  double at(double polar_rad, double azimuth_rad) const;
  // Average over all azimuths about the pole.
  double mean(double polar_rad) const;
  // ∫ I dΩ [sr times the unit of the table], exact to rounding.
  double flux() const { return flux_; }
  double largest() const { return largest_; }

  // Draws directions in the emitter's frame, with equal weight.
  void directions(const FractionBlock& polar, const FractionBlock& azimuth,
                  VectorBlock& direction) const;

  // Effect of the interpolation between the angles of the table on the flux. Both values are
  // relative deviations from flux(): with straight lines between the angles, and with each value
  // constant over the zone around it (the usual sum).
  struct Coarseness {
    double straight = 0.0;
    double zonal = 0.0;
  };
  Coarseness coarseness() const;

 private:
  double curve(const double* value, const double* slope, double polar_rad) const;
  double plane_at(size_t plane, double polar_rad) const;
  // Value at an angle of the table, interpolated between the planes over the whole circle.
  double between_planes(size_t angle, double azimuth_rad) const;
  void find_knots();
  void find_hat_functions();

  struct Hat {
    double before;                // fraction of the flux in the planes before this one
    double fraction;              // of this one
    double centre_rad;            // azimuth of the plane
    double below_rad, above_rad;  // distance to the neighbouring planes; 0 at an open end
  };

  IntensityTable table_;
  std::vector<double> knot_rad_;           // the angles of the table and their middles
  std::vector<double> value_, slope_;      // [plane][knot]
  std::vector<double> mean_, mean_slope_;  // [knot]
  std::vector<PlaneSampler> samplers_;
  std::vector<Hat> hats_;
  double flux_ = 0.0;
  double largest_ = 0.0;
};

}  // namespace photorque
