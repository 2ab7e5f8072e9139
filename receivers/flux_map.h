// Irradiance on part of a scene, bin by bin and in few numbers.
#pragma once

#include <string>
#include <vector>

#include "core/spectrum.h"
#include "raytrace/receiver.h"
#include "receivers/hit_binner.h"
#include "receivers/surface_grid.h"

namespace photorque {

// Light on a grid in one band, or in all together.
struct FluxLayer {
  Estimate power_W;                    // on the whole surface
  std::vector<Estimate> per_bin_W_m2;  // power over area of surface; NaN where there is none
};

// Irradiance and absorbed power density on a surface with their standard errors. Errors of bins are
// correlated; that of power_W comes from the replicates of the total.
struct FluxMap {
  SurfaceGrid grid;
  Bands bands;
  FluxLayer incident;  // all bands
  FluxLayer absorbed;
  std::vector<FluxLayer> incident_by_band;
  std::vector<FluxLayer> absorbed_by_band;
};

// `kind = "flux_map"`. Bins: for every bin of the grid and every band, the incident and then the
// absorbed power [W]; first of the light straight from the emitters, then, in the same order, of
// the light that has met a surface before.
class FluxMapReceiver final : public Receiver {
 public:
  // `grid` must have been laid over `scene`.
  FluxMapReceiver(std::string name, const Scene& scene, SurfaceGrid grid);

  size_t bins() const override;
  // Hits that are scored together must be of one depth.
  void score(const Hits& hits, std::span<double> sums) const override;
  // Entries of direct light, at the front of bins(): incident power in a band of a bin of the grid
  // at entry(bin, band), absorbed power after it.
  size_t direct_entries() const { return bins() / 2; }
  size_t entry(size_t bin, size_t band) const;
  // Maps "irradiance_NAME" and "absorbed_NAME" [W/m²] (also per band when there are several), power
  // on the surface and absorbed by it [W], area [m²], and the statistics.
  Product product(const BinSums& sums) const override;

  // At least two replicates.
  FluxMap flux_map(const BinSums& sums) const;
  // One replicate alone; standard errors are zero.
  FluxMap flux_map(const BinSums& sums, int replicate) const;
  // Incident power in all bands per bin of the grid [W], from the bins of one replicate (or a mean
  // of replicates).
  std::vector<double> incident_W(std::span<const double> bins) const;

  const std::string& name() const { return name_; }
  const SurfaceGrid& grid() const { return grid_; }
  const Bands& bands() const { return bands_; }

 private:
  std::string name_;
  SurfaceGrid grid_;
  Bands bands_;
  HitBinner binner_;
};

// Statistics of the irradiance in all bands. Averages weigh bins by area. Extremes are over bins
// with at least a tenth of the median area of surface (slivers hold too little light to judge) and
// carry the error of their bin: where bins are noisy, they lie outside the true extremes.
struct FluxStatistics {
  Estimate mean_W_m2;
  Estimate min_W_m2;
  Estimate max_W_m2;
  Estimate uniformity;  // min / mean
  // Standard deviation over the surface / mean, with the noise of the bins removed; never negative,
  // so that a uniform field gives a value within its error of zero.
  Estimate variation;
  // Root mean square of standard error / value over bins above 10 % of the maximum.
  double relative_error = 0.0;
};

// `map` must be receiver.flux_map(sums). At least two replicates. All zero for a dark surface.
FluxStatistics flux_statistics(const FluxMapReceiver& receiver, const FluxMap& map,
                               const BinSums& sums);

}  // namespace photorque
