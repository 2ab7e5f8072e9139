// The surface in every bin of a flat grid, as pieces to integrate over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "receivers/surface_grid.h"

namespace photorque {

// A parallelogram (origin + a·edge1 + b·edge2, a, b in [0, 1]) or, with `triangle`, its half with
// a + b ≤ 1. Body frame.
struct SurfacePatch {
  Vec3 origin_m, edge1_m, edge2_m;
  double area_m2 = 0.0;
  uint32_t instance = 0;
  bool triangle = false;

  // Area-preserving from the unit square.
  Vec3 at(double s, double t) const;
};

// Patches in the order of the bins.
struct BinPatches {
  std::vector<SurfacePatch> patches;
  std::vector<uint32_t> first;  // bin b has patches first[b] … first[b + 1] − 1
  Vec3 point_m = Vec3::Zero();  // of the plane
  Vec3 normal = Vec3::UnitZ();  // of the surfaces' fronts

  std::span<const SurfacePatch> of(size_t bin) const {
    return std::span(patches).subspan(first[bin], first[bin + 1] - first[bin]);
  }
};

// True when the grid lies over a plane and all its faces are in one plane, to 1e-6 of the extent.
bool is_flat(const Scene& scene, const SurfaceGrid& grid);

// The pieces of a flat grid; a bin that one instance fills is a single parallelogram.
BinPatches bin_patches(const Scene& scene, const SurfaceGrid& grid);

}  // namespace photorque
