// The interface between the tracer and all measured quantities.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/product.h"
#include "core/spectrum.h"
#include "core/transform.h"

namespace photorque {

// Interactions of rays with surfaces as a structure of arrays, at most `capacity` at a time. All
// vectors are in the body frame.
struct Hits {
  static constexpr int capacity = 256;  // so that all columns stay in the fastest cache together
  // The rows beyond capacity are padding. Without it all columns would map to the same few sets of
  // that cache.
  static constexpr int rows = capacity + 8;
  template <typename T>
  using Column = std::array<T, rows>;

  int count = 0;
  int bands = 1;              // only this many rows of the band columns are filled
  int depth = 0;              // of all hits; 0: directly from the emitter
  Column<uint32_t> instance;  // index into Scene::instances
  Column<uint32_t> triangle;  // index into that mesh's triangles
  Column<uint8_t> front;      // 1: hit from the front, 0: from the back
  // Directions of the arriving rays: unit vectors in single precision, `count` entries each. They
  // point into the tracer's memory and are valid only while it processes these hits.
  std::array<const float*, 3> direction{};
  Column<double> cosine;  // of the angle of incidence, in [0, 1]; to 3e-7
  // on the triangle's plane, to 2e-10 of the scene's size
  std::array<Column<double>, 3> position_m;
  std::array<Column<float>, 2> barycentric;          // weights of the triangle's vertices 1 and 2
  std::array<Column<double>, max_bands> incident_W;  // per band
  std::array<Column<double>, max_bands> absorbed_W;  // per band
  // arriving momentum flow minus expected leaving flow, all bands
  std::array<Column<double>, 3> force_N;

  Vec3 position_at_m(size_t i) const {
    return {position_m[0][i], position_m[1][i], position_m[2][i]};
  }
  Vec3 force_at_N(size_t i) const { return {force_N[0][i], force_N[1][i], force_N[2][i]}; }
};

// Sums of the tracer for one receiver: one vector of bins per replicate. Each replicate is an
// independent, unbiased estimate.
struct BinSums {
  size_t bins = 0;
  int replicates = 0;
  std::vector<double> sums;  // replicate-major: sums[replicate · bins + bin]
  // Per bin: bound of the error that all replicates have in common (of a quadrature). The scatter
  // of the replicates does not show it; it is added to every standard error. Empty if there is
  // none.
  std::vector<double> bound = {};

  // The bins of one replicate.
  std::span<const double> of(int replicate) const {
    return std::span(sums).subspan(static_cast<size_t>(replicate) * bins, bins);
  }
  double bound_of(size_t bin) const { return bound.empty() ? 0.0 : bound[bin]; }
  // Sum of all bounds divided by the sum of the bins' absolute values. It estimates the common
  // relative error of a quantity computed from many bins.
  double common_error() const;
  // Mean and standard error of one bin.
  Estimate estimate(size_t bin) const;
  // Mean and standard error of a linear function of the bins (such as a total or a moment).
  Estimate estimate(const std::function<double(std::span<const double>)>& linear) const;
};

// `estimate` with an additional error that its scatter does not show, added in quadrature. `bound`
// has the unit of the estimate; `common_error` is relative to its value.
Estimate with_bound(const Estimate& estimate, double bound);
Estimate with_common_error(const Estimate& estimate, double common_error);

// A set of bins to which hits contribute. Immutable; called from many threads at once.
class Receiver {
 public:
  virtual ~Receiver() = default;

  // Number of bins per replicate.
  virtual size_t bins() const = 0;

  // Adds the contributions of these hits to `sums` (of bins() entries). Every entry must be a sum
  // over hits, so that batches can be added in any grouping.
  virtual void score(const Hits& hits, std::span<double> sums) const = 0;

  // Results with units and standard errors, from the sums of a trace. `sums` must come from this
  // receiver and have at least two replicates.
  virtual Product product(const BinSums& sums) const = 0;
};

// Standard errors of results that are not linear in the bins.

// Bins averaged over all replicates.
std::vector<double> mean_bins(const BinSums& sums);

// Jackknife estimate of a smooth function of the mean bins, with its standard error; each replicate
// is left out once. Removes the bias of order 1/replicates (all of it for quadratic functions such
// as a variance). Not for extremes, which are not smooth. Requires at least two replicates. Source:
// M. H. Quenouille (Biometrika 43, 1956) for the bias; J. W. Tukey (1958) for the error.
Estimate jackknife(const BinSums& sums,
                   const std::function<double(std::span<const double>)>& statistic);

}  // namespace photorque
