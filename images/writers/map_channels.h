// Maps as channels of image files, and what those files say about themselves.
#pragma once

#include "core/product.h"
#include "core/provenance.h"
#include "images/writers/image_file.h"

namespace photorque {

// "value" and "standard_error" (zeros where the map is exact), rounded to float. Image rows run
// downwards: row 0 is the largest y. InputError if the map's sizes disagree.
std::vector<ImageChannel> map_channels(const Map& map);

// Description: map_json in one line. Texts and numbers: "photorque:unit", "photorque:x_low", …
ImageMetadata map_metadata(const Map& map, const Provenance& provenance);

// The same for a picture without a grid: description is {"title", "provenance"}.
ImageMetadata picture_metadata(const std::string& title, const Provenance& provenance);

}  // namespace photorque
