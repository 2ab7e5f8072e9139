// Intensity over directions as a goniometer measures it: a table of planes.
#pragma once

#include <cstddef>
#include <vector>

#include "core/transform.h"
#include "sources/profiles/sampling.h"

namespace photorque {

// Spherical coordinates about a pole. Which way the pole points in the frame of an emitter (z along
// the beam, x and y across):
enum class Pole {
  beam,        // +z: type C of LM-63, C planes and γ of EULUMDAT
  vertical,    // +x: type A, latitude V and longitude H
  horizontal,  // +y: type B, latitude H and longitude V
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

struct GoniometerAngles {
  double polar_rad = 0.0;    // ∈ [0, π]
  double azimuth_rad = 0.0;  // ∈ (−π, π]
};
// The coordinates of a direction of the emitter's frame (a unit vector). For the pole `beam` the
// azimuth is the photometric C angle: seen from above a luminaire that shines down, C runs against
// the clock from the luminaire's x axis; in the emitter's frame, which looks along the light, it
// therefore runs from +x towards −y.
GoniometerAngles table_angles(Pole pole, const Vec3& direction);

// The interpolant of an intensity table: its value, its flux, and rays drawn from it.
//
// Method. Every plane gets a knot half-way between any two of its angles (monotone_middle()) and is
// then a monotone cubic between knots. The table is a sum of planes, I = Σ_j hat_j(azimuth)
// I_j(polar), with hats that fall linearly to the neighbouring planes. A ray chooses a plane by its
// fraction of the flux, an azimuth within the hat by inverting its quadratic, and a polar angle by
// the plane's PlaneSampler.

class TabulatedIntensity {
 public:
  // The caller has checked the table as IntensityTable demands.
  explicit TabulatedIntensity(IntensityTable table);

  const IntensityTable& table() const { return table_; }

  // The interpolant, in the unit of the table, at coordinates about the table's pole.
  double at(double polar_rad, double azimuth_rad) const;
  // The average over all azimuths about the pole.
  double mean(double polar_rad) const;
  // ∫ I dΩ [sr times the unit of the table], exact to rounding.
  double flux() const { return flux_; }
  double largest() const { return largest_; }

  // Directions in the frame of the emitter with equal weight.
  void directions(const FractionBlock& polar, const FractionBlock& azimuth,
                  VectorBlock& direction) const;

  // Effect of the interpolation between the angles of the table: the flux with straight lines
  // between them, and with each value standing for the zone around it (the usual sum), each over
  // flux() minus one.
  struct Coarseness {
    double straight = 0.0;
    double zonal = 0.0;
  };
  Coarseness coarseness() const;

 private:
  double curve(const double* value, const double* slope, double polar_rad) const;
  double plane_at(size_t plane, double polar_rad) const;
  // The value at an angle of the table between the planes, all the way round.
  double between_planes(size_t angle, double azimuth_rad) const;
  void find_knots();
  void find_hat_functions();

  struct Hat {
    double before;                // fraction of the flux in the planes before this one
    double fraction;              // of this one
    double centre_rad;            // azimuth of the plane
    double below_rad, above_rad;  // distance to its neighbours; 0 at an open end
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
