// Values on a surface grid as a picture.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"
#include "receivers/surface_grid.h"

namespace photorque {

// A Map of one estimate per bin, with the grid's edges and labels. Over a plane, an axis that lies
// along a body axis is called by it.
Map grid_map(const SurfaceGrid& grid, const std::vector<Estimate>& bins, const std::string& name,
             const std::string& title, const std::string& unit);

}  // namespace photorque
