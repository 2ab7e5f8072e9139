// A map as a picture: axes, colour bar, unit, title, caption.
#pragma once

#include <cstdint>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/page_layout.h"

namespace photorque {

// Throws InputError with the name of the map if it has no bins or inconsistent sizes.
void require_consistent(const Map& map);

// Pixels 0xAARRGGBB of `columns` × `rows` that cover the map; row 0 is at the largest y. A pixel
// shows the cell in which it lies; if the map has more cells than pixels, the mean of the covered
// cells. A smooth map is interpolated between its outermost nodes, with contour lines. Transparent
// without a finite value; grey if a bin is_unsure().
std::vector<uint32_t> map_pixels(const Map& map, const ColourScale& scale, int columns, int rows);

// Whether a signed value is within two of its standard errors of zero.
bool is_unsure(const Map& map, size_t bin);

// Uses the colours of colour_scale(map), and hatching for missing values. Equal scales on x and y
// are kept up to a side ratio of 8. The cells are an image; its row 0 is at y_high. Throws
// InputError for inconsistent sizes.
DrawnPage page_of(const Map& map, const Provenance& provenance,
                  PictureStyle style = PictureStyle::page);

// A number on a contour line of a smooth map: its centre in pixels from the top left corner of
// `columns` × `rows`, turned along the line, upright.
struct ContourLabel {
  double column = 0.0, row = 0.0;
  double turn_rad = 0.0;  // counter-clockwise
  double value = 0.0;
  std::string text;
};
// Labels for every other level, at most one each, at least `room` pixels apart and from the edge;
// levels without such a place have none.
std::vector<ContourLabel> contour_labels(const Map& map, const ColourScale& scale, int columns,
                                         int rows, double room);

// Axes, colours and colour bar as an <img> element of an HTML page, half as wide as a plot.
std::string map_html(const Map& map);

// Caption: "min … · mean … · max … W/m² · 100 × 100 bins · standard error … (rms)".
std::string map_caption(const Map& map);

}  // namespace photorque
