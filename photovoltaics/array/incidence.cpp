#include "photovoltaics/array/incidence.h"

#include <algorithm>
#include <array>

#include "raytrace/surfaces/bsdf.h"

namespace photorque {
namespace {

// Linear interpolation with this many steps has an error of 1e-7 where K bends most (grazing, index
// 1.5).
constexpr size_t cosine_steps = 4096;
constexpr double min_cosine = 1e-9;

const OpticalSurface& side_of(const Scene& scene, uint32_t instance, bool front) {
  const Instance& of = scene.instances[instance];
  return scene.surfaces[front ? of.front_surface : of.back_surface];
}

bool depends_on_angle(const OpticalSurface& surface) {
  return surface.bsdf != nullptr && surface.bsdf->law != nullptr;
}

std::array<bool, 2> sides_of(Side side) {
  return {side != Side::front, side != Side::back};  // back, front
}

}  // namespace

bool has_own_front(const Scene& scene, const SurfaceGrid& grid) {
  const std::array<bool, 2> counts = sides_of(grid.side);
  return std::ranges::any_of(grid.instances, [&](uint32_t instance) {
    return (counts[0] && depends_on_angle(side_of(scene, instance, false))) ||
           (counts[1] && depends_on_angle(side_of(scene, instance, true)));
  });
}

IncidenceReceiver::IncidenceReceiver(const Scene& scene, const SurfaceGrid& grid,
                                     const std::optional<CellFront>& front,
                                     std::span<const double> wavelength_m,
                                     const InputLocation& where)
    : binner_(scene, grid),
      bands_(static_cast<size_t>(scene.bands.count())),
      half_(grid.bins() * bands_),
      table_of_(2 * scene.instances.size(), 0) {
  if (front && has_own_front(scene, grid)) {
    throw InputError(where, "array.cover", "cells whose material already has an angular loss",
                     "no cover, or no refractive_index in the material of the cells");
  }
  if (front) {
    add_table([&](double cosine, size_t b) { return front->modifier(cosine, wavelength_m[b]); });
    return;
  }
  add_table([](double, size_t) { return 1.0; });
  const std::array<bool, 2> counts = sides_of(grid.side);
  for (const uint32_t instance : grid.instances) {
    for (const size_t side : {0u, 1u}) {
      const OpticalSurface& surface = side_of(scene, instance, side == 1);
      if (!counts[side] || !depends_on_angle(surface)) continue;
      table_of_[2 * instance + side] = static_cast<uint32_t>(tables_.size());
      add_table([&](double cosine, size_t b) {
        const double upright = fractions_of(surface, 1.0, b).absorbed;
        return upright > 0.0
                   ? fractions_of(surface, std::max(cosine, min_cosine), b).absorbed / upright
                   : 1.0;
      });
    }
  }
}

void IncidenceReceiver::add_table(const Modifier& modifier) {
  Table table;
  for (size_t b = 0; b < bands_; ++b) {
    for (size_t i = 0; i <= cosine_steps; ++i) {
      table.values.push_back(modifier(static_cast<double>(i) / cosine_steps, b));
    }
  }
  tables_.push_back(std::move(table));
}

double IncidenceReceiver::Table::at(double cosine, size_t band) const {
  const double place = cosine * cosine_steps;
  const auto i = std::min(static_cast<size_t>(place), cosine_steps - 1);
  const double* k = &values[band * (cosine_steps + 1) + i];
  return k[0] + (place - static_cast<double>(i)) * (k[1] - k[0]);
}

void IncidenceReceiver::score(const Hits& hits, std::span<double> sums) const {
  BinnedHits binned;
  binner_.bin(hits, binned);
  for (size_t band = 0; band < bands_; ++band) {
    for_each_binned(binned, [&](size_t hit, size_t bin) {
      const Table& table = tables_[table_of_[2 * hits.instance[hit] + hits.front[hit]]];
      const double power_W = hits.incident_W[band][hit];
      const size_t at = bin * bands_ + band;
      sums[at] += power_W;
      sums[half_ + at] += power_W * table.at(hits.cosine[hit], band);
    });
  }
}

}  // namespace photorque
