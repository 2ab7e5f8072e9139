// Places of the cells of an array that are not adjacent equal rectangles.
#pragma once

#include <optional>
#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/array/light.h"

namespace photorque {

// Places in the numbering of the cells.
struct CellPlaces {
  std::vector<std::vector<BinPart>> parts;  // parts of the grid's bins, per cell
  std::vector<Vec2> centres;                // u, v of the grid
  // Cells on a lattice are numbered like equal rectangles, row · columns + column. Other cells form
  // one row in the order in which they were found.
  int columns = 0, rows = 0;
};

// Every connected piece of the surface under the grid is one cell. Triangles that share an edge, on
// one instance of a mesh, are connected. Lattices are detected and numbered row by row.
CellPlaces places_from_mesh(const Scene& scene, const SurfaceGrid& grid);

// Rectangles in the grid's coordinates, in the order given: one row.
CellPlaces places_from_rectangles(std::span<const CellRectangle> cells, const SurfaceGrid& grid);

// Reads the places of the cells from the table `[array]`: `cells = "mesh"` or [[array.rectangle]].
// Returns nothing if `cells` states columns and rows. Throws InputError for rectangles that leave
// the grid, overlap, or are empty, and for gaps in addition to rectangles.
std::optional<CellPlaces> read_cell_places(const Settings& array, const Scene& scene,
                                           const SurfaceGrid& grid);

}  // namespace photorque
