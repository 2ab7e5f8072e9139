// Where the cells of an array lie, when they are not equal rectangles side by side.
#pragma once

#include <optional>
#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/array/light.h"

namespace photorque {

// In the numbering of the cells.
struct CellPlaces {
  std::vector<std::vector<BinPart>> parts;  // of the grid's bins, per cell
  std::vector<Vec2> centres;                // u, v of the grid
  // Cells in a lattice are numbered as equal rectangles are, row · columns + column; others stand
  // in one row in the order in which they were found.
  int columns = 0, rows = 0;
};

// Every connected piece of the surface under the grid is one cell: triangles belong together that
// share an edge, on one instance of a mesh. Lattices are found and numbered row by row.
CellPlaces places_from_mesh(const Scene& scene, const SurfaceGrid& grid);

// Rectangles in the grid's coordinates, in the order given: one row.
CellPlaces places_from_rectangles(std::span<const CellRectangle> cells, const SurfaceGrid& grid);

// Reads where the cells are from the table `[array]`: `cells = "mesh"` or [[array.rectangle]];
// nothing where `cells` counts columns and rows. InputError for rectangles that leave the grid,
// overlap, or are empty, and for gaps beside them.
std::optional<CellPlaces> read_cell_places(const Settings& array, const Scene& scene,
                                           const SurfaceGrid& grid);

}  // namespace photorque
