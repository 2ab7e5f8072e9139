// Fraction of the light on cells that enters their front, from the directions of the rays.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "photovoltaics/cell/front.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"
#include "receivers/hit_binner.h"

namespace photorque {

// Bins: for every bin of a grid and every band the incident power [W], index bin · bands + band;
// and after all of them, in the same order, the sum of power × K, K as in cell/front.h.
// Only the ratio of the two counts, so that it may be applied to light that was found in another
// way.
//
// A surface whose own optics depend on the angle (glass: raytrace/surfaces/bsdf.h) has K =
// absorbed(θ)/ absorbed(0) of these; no second front may be laid over it.
class IncidenceReceiver final : public Receiver {
 public:
  // With `front`, every surface of the grid has it; without, each has its own optics.
  // `wavelength_m` is the mean one of each band. InputError, under `where`, for a front over a
  // surface that has its own.
  IncidenceReceiver(const Scene& scene, const SurfaceGrid& grid,
                    const std::optional<CellFront>& front, std::span<const double> wavelength_m,
                    const InputLocation& where = {});

  size_t bins() const override { return 2 * half_; }
  void score(const Hits& hits, std::span<double> sums) const override;
  // Nothing: its result is ArrayLight::entry.
  Product product(const BinSums&) const override { return {}; }

 private:
  using Modifier = std::function<double(double cosine, size_t band)>;
  // K of each band over even steps of the cosine from 0 to 1, straight in between.
  struct Table {
    std::vector<double> values;
    double at(double cosine, size_t band) const;
  };
  void add_table(const Modifier& modifier);

  HitBinner binner_;
  size_t bands_, half_;
  std::vector<Table> tables_;
  std::vector<uint32_t> table_of_;  // by 2 · instance + front
};

// Whether the optics of a surface of the grid depend on the angle.
bool has_own_front(const Scene& scene, const SurfaceGrid& grid);

}  // namespace photorque
