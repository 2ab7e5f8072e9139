// Layout: the assignment of cells to substrings and strings that gives the largest power.
#pragma once

#include <cstdint>
#include <vector>

#include "photovoltaics/network/curve.h"

namespace photorque {

// Light on the cells, one set of photocurrents per attitude; all attitudes have equal weight.
using AttitudeLights = std::vector<std::vector<double>>;

struct LayoutResult {
  ArrayWiring wiring;
  double power_W = 0.0;        // mean over the attitudes
  double start_power_W = 0.0;  // power of the given wiring
  double bound_W = 0.0;        // upper bound for every wiring
  bool exact = false;          // every assignment was tried, or the bound is reached
  int64_t tried = 0;           // number of evaluated curves
};

// Keeps the shape of `start` (numbers and sizes of its substrings and strings, its diodes) and
// searches better places for its cells. Throws InputError for cross-tied rows. Assignments that
// differ in order only count as one. If there are at most `max_tried`, all are tried. Otherwise
// pairs of cells are exchanged as long as the power rises, within `max_tried` trials. The search
// starts from the given wiring and from one that joins cells of similar light. See layout_bound_W()
// for the bound.
LayoutResult search_layout(const ArrayWiring& start, const CellTables& tables,
                           const AttitudeLights& lights, int64_t max_tried);

// Upper bound of the power of every wiring with the shape of `shape`: the mean of its bounds in
// each light (photocurrents of the cells). In one light it is the sum of the cells' maxima or, for
// S ≥ 1 strings of n cells of one table each, the following lower one.
//
// At a current I a cell has a voltage v(I) that rises with its light. The voltage of a substring is
// an increasing convex function of Σv, because of its diode. Of all ways to cut some cells into
// equal pieces, the one in the order of their light gives the largest sum of such functions,
// because its sums majorise those of any other (G. H. Hardy, J. E. Littlewood, G. Pólya,
// Inequalities, 2nd ed., theorem 108). This order does not depend on I. Let U_k(I) be that sum for
// the k n brightest cells, less k blocking diodes. At the voltage V of the array, the k strings of
// largest current all have at least V at the current I of the k-th string, so k V ≤ U_k(I). That
// current is at most U_k⁻¹(k V), and
//   P ≤ max_V V Σ_k U_k⁻¹(k V).
// One string reaches this bound. Unequal substrings are cut into equal pieces that share the drop
// of their diode, and a real diode in parallel with them counts as one without drop. Both can only
// raise the bound. The maximum over V is bounded from above within 1e-5.
double layout_bound_W(const ArrayWiring& shape, const CellTables& tables,
                      const AttitudeLights& lights);

}  // namespace photorque
