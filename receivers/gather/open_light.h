// Light on bins that nothing can shade, by quadrature. For the files of this folder only.
//
// If the irradiance of some lamps is smooth over a tile of bins, their sum is interpolated by a
// polynomial through its values at Chebyshev points; the last coefficients bound the error. If they
// are too large, or if an edge of a beam crosses the tile, the tile is halved. Remaining single
// bins are integrated along the outline of the surface in the bin (raytrace/direct/disc_light.h),
// which is divided at the known positions of the edges.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "receivers/flux_map.h"
#include "receivers/gather/quadrature.h"
#include "receivers/gather/shaded_sampler.h"

namespace photorque {

// Adds power to the direct entries of a flux map. A Quantity of ShadedSampler.
class FluxEntries {
 public:
  using Value = double;

  FluxEntries(const GatherPlane& plane, const FluxMapReceiver& map) : plane_(plane), map_(map) {}

  // Adds the power in a band, and the part of it that the instance's surface absorbs.
  void add(double power_W, size_t band, size_t bin, uint32_t instance,
           std::span<double> entries) const {
    const size_t at = map_.entry(bin, band);
    entries[at] += power_W;
    entries[at + 1] += power_W * plane_.surface(instance).absorbed[band];
  }
  // The power of a ray.
  double of(const CandidateRay& ray, const GatherLamp&) const { return ray.power_W; }
  // Adds power of a lamp to all bands.
  void add(double power_W, const GatherLamp& lamp, size_t bin, uint32_t instance,
           std::span<double> entries) const;

 private:
  const GatherPlane& plane_;
  const FluxMapReceiver& map_;
};

// Power, and the bounds of its error.
struct OpenEntries {
  std::span<double> power_W, bound_W;
};

// Immutable; called from many threads at once.
class OpenLight {
 public:
  // Target for the error of a bin, relative to the lamp's typical irradiance (or to all of the
  // lamp's light, if that is less).
  static constexpr double tolerance = 3e-7;

  using Lamps = std::vector<const GatherLamp*>;

  // `plane` and `flux` must outlive this object.
  OpenLight(const GatherPlane& plane, const FluxEntries& flux);

  // Adds the light of some lamps on all bins of a tile to `entries`, see FluxEntries. Returns the
  // number of pairs of a bin with a surface and a lamp.
  size_t add(const BinTile& tile, const Lamps& lamps, const OpenEntries& entries) const;

 private:
  // Contributions of the sides of bins to their power, by lamp; two bins share each side. See
  // DiscLight::along_edge_W().
  using Sides = std::unordered_map<uint64_t, Integral<double>>;
  using LampSides = std::map<const GatherLamp*, Sides>;

  // Mean irradiance on the bins of a tile in each band, column by row, with errors.
  using BandMeans = std::vector<Integral<Eigen::MatrixXd>>;

  size_t add(const BinTile& tile, const Lamps& lamps, LampSides& sides,
             const OpenEntries& entries) const;
  std::optional<BandMeans> interpolate(const BinTile& tile, const Ball& ball,
                                       std::span<const size_t> attempts, const Lamps& lamps) const;
  size_t add_smooth(const BinTile& tile, const Ball& ball, const BandMeans& means,
                    const Lamps& lamps, const OpenEntries& entries) const;
  size_t add_bin(const BinTile& tile, const Ball& ball, const GatherLamp& lamp, Sides& sides,
                 const OpenEntries& entries) const;
  Integral<double> power_on_smooth_W(const SurfacePatch& patch, const GatherLamp& lamp,
                                     double tolerance_W_m2) const;
  Integral<double> power_W(const SurfacePatch& patch, const GatherLamp& lamp,
                           double tolerance_W_m2) const;
  Integral<double> power_W(int column, int row, const GatherLamp& lamp, double tolerance_W_m2,
                           Sides& sides) const;
  void add_patch(const Integral<double>& power_W, const SurfacePatch& patch, size_t bin,
                 const GatherLamp& lamp, const OpenEntries& entries) const;

  const GatherPlane& plane_;
  const FluxEntries& flux_;
  ChebyshevTiles tiles_;
};

}  // namespace photorque
