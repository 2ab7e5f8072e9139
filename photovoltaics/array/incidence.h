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

// The bins contain, for every bin of a grid and every band, the incident power [W] at index bin ·
// bands + band, and after all of them, in the same order, the sum of power × K, with K as in
// cell/front.h. Only the ratio of the two is used, so it can be applied to light that was computed
// by another method.
//
// A surface whose own optics depend on the angle (glass: raytrace/surfaces/bsdf.h) has K =
// absorbed(θ)/absorbed(0). It must not have a second front.
class IncidenceReceiver final : public Receiver {
 public:
  // `front`, if given, applies to every surface of the grid; otherwise each surface has its own
  // optics. `wavelength_m`: the mean wavelength of each band. Throws InputError, located at
  // `where`, for a front on a surface whose own optics depend on the angle.
  IncidenceReceiver(const Scene& scene, const SurfaceGrid& grid,
                    const std::optional<CellFront>& front, std::span<const double> wavelength_m,
                    const InputLocation& where = {});

  size_t bins() const override { return 2 * half_; }
  void score(const Hits& hits, std::span<double> sums) const override;
  // Empty: the result of this receiver is ArrayLight::entry.
  Product product(const BinSums&) const override { return {}; }

 private:
  using Modifier = std::function<double(double cosine, size_t band)>;
  // K of each band at equal steps of the cosine from 0 to 1, with linear interpolation.
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
