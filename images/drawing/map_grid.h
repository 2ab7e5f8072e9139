// A map as pixels of a given number.
#pragma once

#include <cstdint>
#include <vector>

#include "core/product.h"
#include "images/drawing/colour_map.h"

namespace photorque {

// 0xAARRGGBB for `columns` × `rows` pixels that cover the map, row 0 at the largest y. A pixel
// shows the cell that it lies in; where the map has more cells than pixels, the mean of those that
// the pixel covers. A smooth map is interpolated between its
// outermost nodes, with contour lines. Transparent where there is no
// finite value; grey where a bin is_unsure().
std::vector<uint32_t> map_pixels(const Map& map, const ColourScale& scale, int columns, int rows);

// Whether a signed value is within two of its standard errors of zero.
bool is_unsure(const Map& map, size_t bin);

}  // namespace photorque
