// The interpolant of an intensity table: its value, its flux, and rays drawn from it.
//
// Method. Every plane gets a knot half-way between any two of its angles (monotone_middle()) and is
// then a monotone cubic between knots. The table is a sum of planes, I = Σ_j hat_j(azimuth)
// I_j(polar), with hats that fall linearly to the neighbouring planes. A ray chooses a plane by its
// fraction of the flux, an azimuth within the hat by inverting its quadratic, and a polar angle by
// the plane's PlaneSampler.
#pragma once

#include <vector>

#include "sources/profiles/block_maps.h"
#include "sources/profiles/intensity_table.h"
#include "sources/profiles/plane_sampler.h"

namespace photorque {

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

  // How much the reading between the angles of the table matters: the flux with straight lines
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
  void find_hats();

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
