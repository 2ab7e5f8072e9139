// What a page says, as the JSON that its script reads.
#pragma once

#include <nlohmann/json.hpp>

#include "images/browser/run_page.h"

namespace photorque {

// Maps reduced to the limit by averaging blocks of bins, long tables cut, curves thinned; each of
// them says so.
nlohmann::ordered_json page_content(const RunPage& page, const PageLimits& limits);

// By how much the sides of each map are divided so that together they keep to `most_bins`: those
// with the most bins first.
std::vector<int> map_reductions(const std::vector<Map>& maps, size_t most_bins);

// `map` with blocks of `factor` × `factor` bins as one: the mean of those that have a value. The
// errors of blocks are not known, as those of bins are correlated, and are left out.
Map reduced(const Map& map, int factor);

}  // namespace photorque
