// A lamp defined by a set of rays.
#pragma once

#include <array>
#include <vector>

#include "raytrace/emitter.h"
#include "sources/photometry/ray_set.h"
#include "sources/profiles/sampling.h"

namespace photorque {

// Draws the rays of a file with probabilities proportional to their flux. The rays are sorted along
// Morton's curve in four dimensions, on which position and direction change little. Well
// distributed samples therefore select well distributed rays.
//
// A file of n rays is itself a sample. Its noise, about 1/√(rays per bin), is not contained in the
// standard errors of a trace.
class RayLamp : public Emitter {
 public:
  // `power_W` of all rays together is > 0; the caller checks this.
  RayLamp(double power_W, const RaySet& set);

  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override;
  // Intensity from steps of the angle that contain equal numbers of rays.
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
  FractionIndex index_;  // of the entries
  // Steps of the intensity: their outer edges in 1 − cos θ, rising, and their values relative to
  // the largest.
  std::vector<double> edge_rise_, step_;
};

}  // namespace photorque
