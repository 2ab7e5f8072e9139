// Sobol points cell by cell: neighbours of the unit hypercube together, without sorting.
//
// The leading bits of the coordinates of a Sobol point are linear in the bits of its index, over
// the field of two elements. All indices whose points share given leading bits therefore form an
// affine subspace, which is enumerated directly; nested scrambling maps cells to cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/numerics/sobol.h"

namespace photorque {

// The first 2^log2_points points of a sequence of group 0, in cells of equal size.
class SobolCells {
 public:
  // The points of a cell share the `leading_bits[d]` first bits of coordinate d. log2_points ∈ [8,
  // 31]; the bits together ≤ log2_points − 8, so that they are independent of each other.
  SobolCells(int log2_points, const std::array<int, sobol_dimensions>& leading_bits);

  uint32_t cells() const { return uint32_t{1} << cell_basis_.size(); }
  uint32_t points_per_cell() const { return uint32_t{1} << inner_basis_.size(); }

  // Writes points first … first + sobol_block − 1 of a cell to four arrays of sobol_block, as
  // sobol_points() does, and their indices in the sequence. `first` must be a multiple of
  // sobol_block.
  void points(const SobolStream& stream, uint32_t cell, uint32_t first,
              const std::array<uint32_t*, sobol_dimensions>& out, uint32_t* index) const;

 private:
  // Indices whose sums (exclusive or) are one index of every cell, and all indices of the first.
  std::vector<uint32_t> cell_basis_, inner_basis_;
  // The first block of the first cell: indices, and points before scrambling, their bits reversed.
  std::array<uint32_t, sobol_block> block_index_;
  std::array<std::array<uint32_t, sobol_block>, sobol_dimensions> block_point_;
};

}  // namespace photorque
