// A lamp that is a set of rays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raytrace/emitter.h"
#include "sources/photometry/ray_set.h"

namespace photorque {

// Gives the rays of a file with probabilities that go with their flux. They are put in an order
// along which position and direction change little (Morton's curve in four dimensions), so that
// well distributed samples meet well distributed rays.
//
// A file of n rays is itself a sample: its noise, about 1/√(rays per bin), is not in the standard
// errors of a trace.
class RayLamp : public Emitter {
 public:
  // Power of all rays together, > 0; the caller checks.
  RayLamp(double power_W, const RaySet& set);

  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override;
  // Intensity from steps of the angle with equal numbers of rays.
  double relative_intensity(double angle_rad) const override;

 private:
  struct Entry {
    double before;  // fraction of the flux in the rays before this one
    std::array<double, 3> origin_m;
    std::array<double, 3> direction;
  };
  void tabulate_intensity(const RaySet& set);

  double power_W_;
  std::vector<Entry> entries_;
  std::vector<uint32_t> first_entry_;  // for evenly spaced fractions
  // Steps of the intensity: their outer edges in 1 − cos θ, rising, and their values over the
  // largest.
  std::vector<double> edge_rise_, step_;
};

}  // namespace photorque
