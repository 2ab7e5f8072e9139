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
// See layout_bound.h for the bound.
LayoutResult search_layout(const ArrayWiring& start, const CellTables& tables,
                           const AttitudeLights& lights, int64_t max_tried);

}  // namespace photorque
