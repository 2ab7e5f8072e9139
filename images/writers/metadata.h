// Metadata of every file, and maps as channels of image files.
#pragma once

#include <nlohmann/json.hpp>

#include "core/product.h"
#include "core/provenance.h"
#include "images/writers/image_file.h"

namespace photorque {

// JSON object {"program", "version", "git_hash", "seed", "inputs": {file: hash}}.
nlohmann::ordered_json provenance_json(const Provenance& provenance);

// JSON on one line of ASCII (other characters escaped), for formats whose text is ASCII or Latin-1.
std::string ascii_line(const nlohmann::ordered_json& json);

// Channels "value" and "standard_error" (zeros if the map is exact), rounded to float. Image rows
// run downwards: row 0 is the largest y. Throws InputError if the map's sizes disagree.
std::vector<ImageChannel> map_channels(const Map& map);

// Metadata of a map: the description is a JSON object {"name", "title", "unit", "x_label", …,
// "rows": "top row is the largest y", "provenance"} on one line; texts and numbers are
// "photorque:unit", "photorque:x_low", …
ImageMetadata map_metadata(const Map& map, const Provenance& provenance);

// Metadata of a picture without a grid: the description is {"title", "provenance"}.
ImageMetadata picture_metadata(const std::string& title, const Provenance& provenance);

}  // namespace photorque
