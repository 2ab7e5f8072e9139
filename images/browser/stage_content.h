// The stage of a page as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "core/product.h"
#include "images/browser/run_page.h"

namespace photorque {

// `product` has the maps that painted surfaces name. Of a scene with more triangles than the limit
// the parts with the most are shown as boxes.
nlohmann::ordered_json stage_content(const SceneStage& stage, const Product& product,
                                     const PageLimits& limits);

}  // namespace photorque
