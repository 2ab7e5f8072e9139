// A map as a picture: axes, colour bar, unit, title, caption.
#pragma once

#include <cstdint>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/canvas.h"
#include "images/drawing/colour.h"
#include "images/drawing/style.h"

namespace photorque {

// InputError that names the map if it has no bins or sizes of its parts disagree.
void require_consistent(const Map& map);

// 0xAARRGGBB for `columns` × `rows` pixels that cover the map, row 0 at the largest y. A pixel
// shows the cell that it lies in; where the map has more cells than pixels, the mean of those that
// the pixel covers. A smooth map is interpolated between its outermost nodes, with contour lines.
// Transparent where there is no finite value; grey where a bin is_unsure().
std::vector<uint32_t> map_pixels(const Map& map, const ColourScale& scale, int columns, int rows);

// Whether a signed value is within two of its standard errors of zero.
bool is_unsure(const Map& map, size_t bin);

struct MapPicture {
  Picture picture;
  // The pixels that show the grid, sharp cells edge to edge: row 0 of the grid's pixels is y_high.
  int grid_left = 0;
  int grid_top = 0;
  int grid_width = 0;
  int grid_height = 0;
};

// Colours as by colour_scale(map); hatched where a value is missing. Equal scales on x and y are
// kept up to a ratio of 8 between the sides. InputError if the map's sizes disagree.
MapPicture map_picture(const Map& map, const Provenance& provenance,
                       PictureStyle style = PictureStyle::page);
// As a page of vectors, on which the cells are an image.
std::string svg_of(const Map& map, const Provenance& provenance, PictureStyle style);
std::string pdf_of(const Map& map, const Provenance& provenance, const PdfText& text,
                   PictureStyle style);

// A number on a contour line of a smooth map: the middle of it in pixels from the top left corner
// of `columns` × `rows` ones, along the line, upright.
struct ContourLabel {
  double column = 0.0, row = 0.0;
  double turn_rad = 0.0;  // anticlockwise as seen
  double value = 0.0;
  std::string text;
};
// Every other level has at most one, `room` pixels from the next and from the edge; levels without
// such a place have none.
std::vector<ContourLabel> contour_labels(const Map& map, const ColourScale& scale, int columns,
                                         int rows, double room);

// Axes, colours and their bar alone as an <img> element of an HTML page, half as
// wide as plots are there.
std::string map_html(const Map& map);

// "min … · mean … · max … W/m² · 100 × 100 bins · standard error … (rms)".
std::string map_caption(const Map& map);

}  // namespace photorque
