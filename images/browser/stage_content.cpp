#include "images/browser/content.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.h"
#include "core/text/format.h"
#include "images/drawing/colour.h"

namespace photorque {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// Replaces a part by its bounding box along the body axes.
StagePart box_of(const StagePart& part) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> low = {infinity, infinity, infinity},
                       high = {-infinity, -infinity, -infinity};
  for (size_t i = 0; i < part.position_m.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], part.position_m[i]);
    high[i % 3] = std::max(high[i % 3], part.position_m[i]);
  }
  StagePart box{part.name, part.colour, {}, {}};
  for (size_t corner = 0; corner < 8; ++corner) {
    for (size_t k = 0; k < 3; ++k) box.position_m.push_back((corner >> k & 1) ? high[k] : low[k]);
  }
  box.triangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                   2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return box;
}

// All parts; the largest become boxes until the number of triangles is within the limit.
std::vector<StagePart> shown_parts(std::vector<StagePart> parts, size_t most_triangles,
                                   size_t& boxes) {
  size_t total = 0;
  for (const StagePart& part : parts) total += part.triangles.size() / 3;
  while (total > most_triangles) {
    const auto largest = std::ranges::max_element(
        parts, {}, [](const StagePart& part) { return part.triangles.size(); });
    if (largest == parts.end() || largest->triangles.size() <= 36) break;
    total -= largest->triangles.size() / 3;
    *largest = box_of(*largest);
    total += largest->triangles.size() / 3;
    ++boxes;
  }
  return parts;
}

Json part_json(const StagePart& part) {
  return {{"name", clean_text(part.name)},
          {"colour", rgb_bytes(part.colour)},
          {"position", packed(part.position_m)},
          {"triangles", packed(part.triangles)}};
}

Json surface_json(const PaintedSurface& surface, const ColourScale& scale) {
  static constexpr const char* sides[] = {"front", "back", "both"};
  Json json = {{"name", clean_text(surface.name)},
               {"position", packed(surface.position_m)},
               {"uv", packed(surface.uv)},
               {"triangles", packed(surface.triangles)},
               {"side", sides[static_cast<size_t>(surface.side)]}};
  if (!surface.map.empty()) json["map"] = clean_text(surface.map);
  Json frames = Json::array();
  for (const Map& map : surface.map_of_light) {
    if (frames.empty()) {
      json["width"] = map.width;
      json["height"] = map.height;
      json["bins"] = {map.width, map.height};
      json["factor"] = 1;
    }
    frames.push_back(packed_coarse(map.value, scale.low, scale.high));
  }
  if (!frames.empty()) json["frames"] = std::move(frames);
  return json;
}

// One scale for all surfaces that are painted together, over all states.
ColourScale scale_of(const Painting& painting, const Product& product) {
  Extent extent;
  const auto extend = [&](const Map& map) {
    for (const double value : map.value) extent.include(value);
  };
  for (const PaintedSurface& surface : painting.surfaces) {
    for (const Map& map : surface.map_of_light) extend(map);
    const auto named = std::ranges::find(product.maps, surface.map, &Map::name);
    if (surface.map_of_light.empty() && named == product.maps.end()) {
      throw InputError({}, "page", "a surface painted with \"" + surface.map + "\"", "a map");
    }
    if (named != product.maps.end()) extend(*named);
  }
  return colour_scale(extent, painting.signed_values);
}

Json painting_json(const Painting& painting, const Product& product) {
  const ColourScale scale = scale_of(painting, product);
  const auto surface = [&](const PaintedSurface& one) { return surface_json(one, scale); };
  return {{"title", clean_text(painting.title)},
          {"unit", clean_text(painting.unit)},
          {"colours", colours_of(scale, painting.signed_values)},
          {"low", scale.low},
          {"high", scale.high},
          {"surfaces", list_of(painting.surfaces, surface)}};
}

Json lamp_json(const StageLamp& lamp) {
  return {{"name", clean_text(lamp.name)},
          {"position", vector_json(lamp.position_lab_m)},
          {"direction", vector_json(lamp.direction_lab)},
          {"radius", lamp.radius_m},
          {"far", lamp.is_far}};
}

Json arrow_json(const StageArrow& arrow) {
  static constexpr const char* kinds[] = {"force", "torque", "turn"};
  return {{"name", clean_text(arrow.name)},
          {"unit", clean_text(arrow.unit)},
          {"kind", kinds[static_cast<size_t>(arrow.kind)]},
          {"m_per_unit", arrow.m_per_unit},
          {"remark", clean_text(arrow.remark)}};
}

// Columns of numbers, concatenated over all states.
Json states_json(const SceneStage& stage) {
  std::vector<double> attitudes, arrows, errors, figures, figure_errors;
  for (const StageState& state : stage.states) {
    if (state.lab_from_body.size() != stage.bodies.size() ||
        state.arrow_body.size() != stage.arrows.size() ||
        state.arrow_error_body.size() != stage.arrows.size() ||
        state.figures.size() != stage.figures.size()) {
      throw InputError({}, "page", "a state with other bodies, arrows or figures than its stage",
                       "as many");
    }
    for (const Quat& q : state.lab_from_body) {
      for (const double part : {q.w(), q.x(), q.y(), q.z()}) attitudes.push_back(part);
    }
    for (size_t i = 0; i < stage.arrows.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        arrows.push_back(state.arrow_body[i][k]);
        errors.push_back(state.arrow_error_body[i][k]);
      }
    }
    for (const Estimate& figure : state.figures) {
      figures.push_back(figure.value);
      figure_errors.push_back(figure.standard_error);
    }
  }
  return {{"count", stage.states.size()}, {"attitude", packed(attitudes)},
          {"arrow", packed(arrows)},      {"arrow_error", packed(errors)},
          {"figure", packed(figures)},    {"figure_error", packed(figure_errors)}};
}

Json axis_json(const StageAxis& axis) {
  return {{"name", clean_text(axis.name)},
          {"unit", clean_text(axis.unit)},
          {"values", packed(axis.values)},
          {"plays", axis.plays},
          {"names", list_of(axis.names, clean_text)}};
}

}  // namespace

Json stage_content(const SceneStage& stage, const Product& product, const PageLimits& limits) {
  size_t nodes = 1, boxes = 0;
  for (const StageAxis& axis : stage.axes) nodes *= axis.values.size();
  if (nodes != stage.states.size()) {
    throw InputError({}, "page", std::to_string(stage.states.size()) + " states",
                     std::to_string(nodes) + ", as many as the axes have nodes");
  }
  const std::vector<StagePart> parts = shown_parts(stage.parts, limits.triangles, boxes);
  const auto painting = [&](const Painting& one) { return painting_json(one, product); };
  const auto body = [](const std::string& name) { return Json{{"name", clean_text(name)}}; };
  const auto figure = [](const StageFigure& one) {
    return Json{{"label", clean_text(one.label)}, {"unit", clean_text(one.unit)}};
  };
  std::string remark = stage.remark;
  if (boxes > 0) {
    remark +=
        (remark.empty() ? "" : " ") + std::to_string(boxes) +
        (boxes == 1 ? " part with very many triangles is" : " parts with very many triangles are") +
        " drawn as boxes.";
  }
  return {{"parts", list_of(parts, part_json)},
          {"paintings", list_of(stage.paintings, painting)},
          {"lamps", list_of(stage.lamps, lamp_json)},
          {"bodies", list_of(stage.bodies, body)},
          {"arrows", list_of(stage.arrows, arrow_json)},
          {"figures", list_of(stage.figures, figure)},
          {"axes", list_of(stage.axes, axis_json)},
          {"states", states_json(stage)},
          {"rays", list_of(stage.rays_of_light_lab_m, packed<float>)},
          {"light_of_state", stage.light_of_state},
          {"camera",
           {{"position", vector_json(stage.camera.position_lab_m)},
            {"target", vector_json(stage.camera.target_lab_m)},
            {"field_of_view_deg", stage.camera.field_of_view_deg}}},
          {"radius", stage.radius_m},
          {"remark", clean_text(remark)}};
}

}  // namespace photorque
