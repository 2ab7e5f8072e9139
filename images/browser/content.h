// Content of a page as the JSON that its script reads, and the script itself.
#pragma once

#include <bit>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "core/product.h"
#include "core/text/format.h"
#include "images/browser/run_page.h"
#include "images/drawing/colour.h"

namespace photorque {

// Encoded numbers {"f32": "…"}, {"f64": "…"}, {"u32": "…"} or {"u16": "…"}: little-endian, in
// base64. NaN is preserved.
template <class T>
nlohmann::ordered_json packed(const std::vector<T>& numbers) {
  static_assert(std::endian::native == std::endian::little, "pages hold little-endian numbers");
  const std::string type = (std::is_integral_v<T> ? "u" : "f") + std::to_string(8 * sizeof(T));
  return {{type, base64(std::as_bytes(std::span(numbers)))}};
}
// As {"f32": …}, rounded to single precision.
nlohmann::ordered_json packed_rounded(std::span<const double> numbers);
// Encoded as {"u16": "…", "low", "step"}: value = low + step · n for n < 65535; n = 65535 is NaN.
// The error is at most half a step, 1/131068 of the range.
nlohmann::ordered_json packed_coarse(std::span<const double> numbers, double low, double high);

// `json` as text that is safe between <script> and </script>: no character of it can end the
// element or begin a comment.
std::string script_text(const nlohmann::ordered_json& json);

// The names of the colours of a scale in the script.
inline const char* colours_of(const ColourScale& scale, bool signed_values) {
  return signed_values && scale.low == -scale.high ? "cool_warm" : "viridis";
}

// An array of what `json_of` makes of each item.
template <class Item, class JsonOf>
nlohmann::ordered_json list_of(const std::vector<Item>& items, const JsonOf& json_of) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Item& item : items) list.push_back(json_of(item));
  return list;
}

// Content of a page within its limits: large maps are reduced by averaging blocks of bins, long
// tables are cut, curves are thinned. Each of them contains a note about it.
nlohmann::ordered_json page_content(const RunPage& page, const PageLimits& limits);

// Factors by which the sides of each map are divided, so that all maps together have at most
// `most_bins` bins. Maps with the most bins are reduced first.
std::vector<int> map_reductions(const std::vector<Map>& maps, size_t most_bins);

// `map` with blocks of `factor` × `factor` bins as one bin: the mean of those that have a value. It
// has no errors, because those of the bins are correlated.
Map reduced(const Map& map, int factor);

// JSON of the scene. `product` must contain the maps that painted surfaces name. If the scene has
// more triangles than the limit, the parts with the most triangles are shown as boxes.
nlohmann::ordered_json stage_content(const SceneStage& stage, const Product& product,
                                     const PageLimits& limits);

// The file script/page.min.js: script/*.js and three.js, bundled by tools/page_script.
std::string_view page_script();
// The file script/page.css.
std::string_view page_style();

}  // namespace photorque
