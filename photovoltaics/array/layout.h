// Which cells to join: the assignment of cells to substrings and strings that gives most power.
#pragma once

#include <cstdint>
#include <vector>

#include "photovoltaics/network/curve.h"

namespace photorque {

// Light on the cells, one set of photocurrents per attitude; all attitudes count the same.
using AttitudeLights = std::vector<std::vector<double>>;

struct LayoutResult {
  ArrayWiring wiring;
  double power_W = 0.0;        // mean over the attitudes
  double start_power_W = 0.0;  // of the wiring given
  double bound_W = 0.0;        // no wiring gives more
  bool exact = false;          // every assignment was tried, or the bound is reached
  int64_t tried = 0;           // curves whose maximum was found
};

// Keeps the shape of `start` (numbers and sizes of its substrings and strings, its diodes) and
// looks for better places for its cells; only substrings without cross-tied rows are supported
// (InputError). Assignments that differ by order alone count once. If there are at most
// `max_tried`, all are tried; else pairs of cells are exchanged while that helps, from the given
// wiring and from one with cells of like light joined, within `max_tried` trials.
// See layout_bound_W() for the bound.
LayoutResult search_layout(const ArrayWiring& start, const CellTables& tables,
                           const AttitudeLights& lights, int64_t max_tried);

// Upper bound of the power of every wiring with the shape of `shape` under a light (photocurrents
// of the cells): the sum of the cells' maxima or, for S ≥ 1 strings of n cells of one table each, a
// lower one:
//
// At a current I a cell has a voltage v(I) that rises with its light, and a substring has Σv or
// what its diode leaves, an increasing convex function of Σv. Of all ways to cut some cells into
// equal pieces, the one in the order of their light gives the largest sum of such functions,
// because its sums majorise those of any other (G. H. Hardy, J. E. Littlewood, G. Pólya,
// Inequalities, 2nd ed., theorem 108), and the order does not depend on I. Let U_k(I) be that sum
// for the k n brightest cells, less k blocking diodes. At the voltage V of the array the k strings
// of most current all have at least V at the current I of the k-th, so k V ≤ U_k(I): that current
// is at most U_k⁻¹(k V), and
//   P ≤ max_V V Σ_k U_k⁻¹(k V).
// One string reaches it. Unequal substrings are cut into equal pieces that share the drop of their
// diode, and a real diode beside them counts as one without drop: both only raise the bound. The
// maximum over V is bounded from above within 1e-5.
double layout_bound_W(const ArrayWiring& shape, const CellTables& tables,
                      const std::vector<double>& light_A);

// The mean over several lights: one wiring for all cannot exceed it either.
double layout_bound_W(const ArrayWiring& shape, const CellTables& tables,
                      const std::vector<std::vector<double>>& lights_A);

}  // namespace photorque
