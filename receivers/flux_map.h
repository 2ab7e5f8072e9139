// Irradiance on part of a scene, per bin and as statistics.
#pragma once

#include <string>
#include <vector>

#include "core/spectrum.h"
#include "raytrace/receiver.h"
#include "receivers/hit_binner.h"
#include "receivers/surface_grid.h"

namespace photorque {

// Light on a grid in one band, or in all bands together.
struct FluxLayer {
  Estimate power_W;  // on the whole surface
  // power divided by the area of surface; NaN for bins without surface
  std::vector<Estimate> per_bin_W_m2;
};

// Irradiance and absorbed power density on a surface with their standard errors. Errors of bins are
// correlated; the error of power_W comes from the replicates of the total.
struct FluxMap {
  SurfaceGrid grid;
  Bands bands;
  FluxLayer incident;  // all bands
  FluxLayer absorbed;
  std::vector<FluxLayer> incident_by_band;
  std::vector<FluxLayer> absorbed_by_band;
};

// `kind = "flux_map"`. Bins: for every bin of the grid and every band, the incident and then the
// absorbed power [W]. The first half is light directly from the emitters, the second half, in the
// same order, light that has met a surface before.
class FluxMapReceiver final : public Receiver {
 public:
  // `grid` must have been made for `scene`.
  FluxMapReceiver(std::string name, const Scene& scene, SurfaceGrid grid);

  size_t bins() const override;
  void score(const Hits& hits, std::span<double> sums) const override;
  // Number of bins of direct light; they are the first half of bins(). The incident power in a band
  // of a bin of the grid is at entry(bin, band), the absorbed power at the next index.
  size_t direct_entries() const { return bins() / 2; }
  size_t entry(size_t bin, size_t band) const;
  // Maps "irradiance_NAME" and "absorbed_NAME" [W/m²] (also per band if there are several),
  // incident and absorbed power [W], area [m²], and the statistics.
  Product product(const BinSums& sums) const override;

  // Requires at least two replicates.
  FluxMap flux_map(const BinSums& sums) const;
  // Incident power in all bands per bin of the grid [W], from the bins of one replicate or of a
  // mean over replicates.
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

// Statistics of the irradiance in all bands. Averages are weighted by area. Extremes are taken over
// bins with at least a tenth of the median area, because slivers receive too little light. They
// have the error of their bin: noise of the bins shifts them beyond the true extremes.
struct FluxStatistics {
  Estimate mean_W_m2;
  Estimate min_W_m2;
  Estimate max_W_m2;
  Estimate uniformity;  // min / mean
  // Standard deviation over the surface divided by the mean, without the noise of the bins. Never
  // negative, so that a uniform field gives a value that agrees with zero within its error.
  Estimate variation;
  // Root mean square of standard error / value over bins above 10 % of the maximum.
  double relative_error = 0.0;
};

// `map` must be receiver.flux_map(sums). Requires at least two replicates. All values are zero for
// a dark surface.
FluxStatistics flux_statistics(const FluxMapReceiver& receiver, const FluxMap& map,
                               const BinSums& sums);

}  // namespace photorque
