// The interpolant of an intensity table: its value, its flux, and rays drawn from it.
//
// Method. Every plane gets a knot half-way between any two of its angles (monotone_middle()) and is
// then a monotone cubic between knots. The table is a sum of planes, I = Σ_j hat_j(azimuth)
// I_j(polar), with hats that fall linearly to the neighbouring planes. A ray chooses a plane by its
// share of the flux, an azimuth within the hat by inverting its quadratic, and a polar angle by the
// plane's own distribution. That is tabulated at cells so fine that within them the intensity is
// linear in the rise 1 − cos θ to `cell_error` of the flux; every cell holds its exact flux
// (Gauss–Legendre with 8 nodes on cubics times a sine: rounding), and a quadratic is inverted
// within it.
#pragma once

#include <cstdint>
#include <vector>

#include "sources/block_maps.h"
#include "sources/intensity_table.h"

namespace photorque {

// The distribution of the polar angle in one plane, for equal-share sampling.
class PlaneSampler {
 public:
  // Knots of the plane's cubic: angles, intensities and slopes of one length.
  PlaneSampler(const std::vector<double>& polar_rad, const double* intensity, const double* slope);

  // ∫ I sin θ dθ over the plane, ≥ 0.
  double flux() const { return flux_; }
  // 1 − cos θ below which a share ∈ (0, 1) of the flux lies. Only where flux() > 0.
  double rise(double share) const;

 private:
  struct Cell {
    double before;     // share of the flux below the cell
    double rise;       // of its lower edge
    double width;      // in rise
    double low, high;  // share per rise at its edges
  };
  struct Curve;
  void add(const Curve& curve, double low_rad, double high_rad, double plane_flux, int depth);

  double flux_ = 0.0;
  std::vector<Cell> cells_;
  std::vector<uint32_t> first_cell_;  // for evenly spaced shares
};

class TabulatedIntensity {
 public:
  static constexpr double cell_error = 1e-8;

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
    double before;                // share of the flux in the planes before this one
    double share;                 // of this one
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
