// The content of a page as the JSON that its script reads, and that script.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "core/product.h"
#include "images/browser/run_page.h"

namespace photorque {

// {"f32": "…"}, {"f64": "…"}, {"u32": "…"}: little-endian numbers in base64. NaN stays NaN.
nlohmann::ordered_json packed(std::span<const float> numbers);
nlohmann::ordered_json packed(std::span<const double> numbers);
nlohmann::ordered_json packed(std::span<const uint32_t> numbers);
// As {"f32": …}, rounded.
nlohmann::ordered_json packed_rounded(std::span<const double> numbers);
// {"u16": "…", "low", "step"}: value = low + step · n for n < 65535, which stands for NaN; within
// half a step, 1/131068 of the range.
nlohmann::ordered_json packed_coarse(std::span<const double> numbers, double low, double high);

// `json` as text that may stand between <script> and </script>: no character of it can end the
// element or begin a comment.
std::string script_text(const nlohmann::ordered_json& json);

// Maps reduced to the limit by averaging blocks of bins, long tables cut, curves thinned; each of
// them notes it.
nlohmann::ordered_json page_content(const RunPage& page, const PageLimits& limits);

// By how much the sides of each map are divided so that together they keep to `most_bins`: those
// with the most bins first.
std::vector<int> map_reductions(const std::vector<Map>& maps, size_t most_bins);

// `map` with blocks of `factor` × `factor` bins as one: the mean of those that have a value. The
// errors of blocks are not known, as those of bins are correlated, and are left out.
Map reduced(const Map& map, int factor);

// `product` has the maps that painted surfaces name. Of a scene with more triangles than the limit
// the parts with the most are shown as boxes.
nlohmann::ordered_json stage_content(const SceneStage& stage, const Product& product,
                                     const PageLimits& limits);

// script/page.min.js: all that script/*.js and three.js make, bundled by tools/page_script.
std::string_view page_script();
// script/page.css.
std::string_view page_style();

}  // namespace photorque
