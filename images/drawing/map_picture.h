// A map as a picture for people: axes, colour bar, unit, title, caption.
#pragma once

#include "core/product.h"
#include "core/provenance.h"
#include "images/canvas/canvas.h"
#include "images/canvas/picture.h"

namespace photorque {

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
MapPicture map_picture(const Map& map, const Provenance& provenance);

// Axes, colours and their bar alone as an <svg> element for the inside of an HTML page, half as
// wide as plots are there.
std::string map_html(const Map& map);

// "min … · mean … · max … W/m² · 100 × 100 bins · standard error … (rms)".
std::string map_caption(const Map& map);

}  // namespace photorque
