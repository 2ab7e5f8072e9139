#include "images/browser/content.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numerics/series.h"
#include "core/text/format.h"
#include "images/drawing/colour.h"
#include "images/drawing/plot.h"
#include "images/writers/metadata.h"

namespace photorque {
namespace {

using Json = nlohmann::ordered_json;

Json figure_json(const PageFigure& figure) {
  return {{"key", clean_text(figure.key)},
          {"label", clean_text(figure.label)},
          {"unit", clean_text(figure.unit)},
          {"value", figure.estimate.value},
          {"error", figure.estimate.standard_error}};
}

Json stage_json(const PowerStage& stage) {
  return {{"label", clean_text(stage.label)},
          {"value", stage.power_W.value},
          {"error", stage.power_W.standard_error},
          {"total", stage.is_total}};
}

Json table_json(const Table& table, size_t most_rows) {
  const size_t rows = table.columns.empty() ? 0 : table.columns.front().size();
  const size_t shown = std::min(rows, most_rows);
  Json columns = Json::array();
  for (const Table::Column& column : table.columns) {
    Json cells = Json::array();
    for (size_t i = 0; i < std::min(shown, column.size()); ++i) {
      if (column.texts.empty()) {
        cells.push_back(column.values[i]);
      } else {
        cells.push_back(clean_text(column.texts[i]));
      }
    }
    columns.push_back({{"name", clean_text(column.name)}, {"cells", std::move(cells)}});
  }
  return {{"name", clean_text(table.name)},
          {"title", clean_text(table.title)},
          {"rows", rows},
          {"columns", std::move(columns)}};
}

Json curve_json(const Plot::Curve& curve, size_t most_points) {
  static constexpr const char* colours[] = {"", "blue", "vermilion", "green", "grey"};
  const std::vector<size_t> kept = lows_and_highs(curve.y, most_points);
  const auto pick = [&](const std::vector<double>& of) {
    std::vector<double> picked;
    for (const size_t i : kept) {
      picked.push_back(i < of.size() ? of[i] : std::numeric_limits<double>::quiet_NaN());
    }
    return picked;
  };
  Json json = {{"label", clean_text(curve.label)},
               {"x", packed(pick(curve.x))},
               {"y", packed_rounded(pick(curve.y))},
               {"style", curve.bars                    ? "bars"
                         : curve.markers || curve.dots ? "points"
                         : curve.dashed                ? "dashed"
                                                       : "line"},
               {"colour", colours[static_cast<size_t>(curve.colour)]},
               {"thinned_from", kept.size() < curve.y.size() ? curve.y.size() : 0}};
  if (!curve.y_error.empty()) json["error"] = packed_rounded(pick(curve.y_error));
  return json;
}

Json panel_json(const Plot::Panel& panel, const PageLimits& limits) {
  const auto json_of = [&](const Plot::Curve& one) { return curve_json(one, limits.curve_points); };
  return {{"y_label", clean_text(panel.y_label)},
          {"log", panel.y_log},
          {"robust", panel.robust_range},
          {"levels", panel.levels},
          {"curves", list_of(panel.curves, json_of)}};
}

Json plot_json(const Plot& of, const RunPage& page, const PageLimits& limits) {
  const Plot plot = with_readable_time_unit(of);
  const auto panel = [&](const Plot::Panel& one) { return panel_json(one, limits); };
  const auto interval = [](const Plot::Interval& one) { return Json{one.from, one.to}; };
  Json json = {{"name", clean_text(plot.name)},
               {"title", clean_text(plot.title)},
               {"x_label", clean_text(plot.x_label)},
               {"x_log", plot.x_log},
               {"shaded", list_of(plot.shaded, interval)},
               {"shaded_label", clean_text(plot.shaded_label)},
               {"panels", list_of(panels_of(plot), panel)}};
  const double per_unit = seconds_of_unit(plot) / seconds_of_unit(of);
  const auto cursor = std::ranges::find(page.cursors, plot.name, &PlotCursor::plot);
  if (cursor != page.cursors.end()) {
    json["cursor"] = {{"axis", cursor->axis},
                      {"x_per_unit", cursor->x_per_unit / per_unit},
                      {"x_from", cursor->x_from / per_unit}};
    if (cursor->only_at) {
      json["cursor"]["only_at"] = {{"axis", cursor->only_at->first},
                                   {"value", cursor->only_at->second}};
    }
  }
  return json;
}

Json map_content(const Map& map, int factor) {
  const Map small = factor > 1 ? reduced(map, factor) : map;
  const ColourScale scale = colour_scale(map);
  Json json = {{"name", clean_text(map.name)},
               {"title", clean_text(map.title)},
               {"unit", clean_text(map.unit)},
               {"width", small.width},
               {"height", small.height},
               {"bins", {map.width, map.height}},
               {"factor", factor},
               {"x_low", map.x_low},
               {"x_high", map.x_high},
               {"y_low", map.y_low},
               {"y_high", map.y_high},
               {"x_label", clean_text(map.x_label)},
               {"y_label", clean_text(map.y_label)},
               {"equal_scale", map.equal_scale},
               {"smooth", map.smooth},
               {"colours", colours_of(scale, map.signed_values)},
               {"low", scale.low},
               {"high", scale.high},
               {"value", packed_rounded(small.value)}};
  if (!small.standard_error.empty()) json["error"] = packed_rounded(small.standard_error);
  return json;
}

Json colours_json(const ColourMap& map) {
  std::string hex;
  for (const Rgb& colour : map.colours) {
    const auto [red, green, blue] = rgb_bytes(colour);
    hex += printed("%02x%02x%02x", red, green, blue);
  }
  return hex;
}

size_t bins_of(const Map& map, int factor) {
  return static_cast<size_t>((map.width + factor - 1) / factor) *
         static_cast<size_t>((map.height + factor - 1) / factor);
}

}  // namespace

std::vector<int> map_reductions(const std::vector<Map>& maps, size_t most_bins) {
  std::vector<int> factors(maps.size(), 1);
  std::vector<size_t> bins;
  size_t total = 0;
  for (const Map& map : maps) total += bins.emplace_back(bins_of(map, 1));
  while (total > most_bins) {
    const auto largest = static_cast<size_t>(std::ranges::max_element(bins) - bins.begin());
    if (bins[largest] <= 1) break;
    factors[largest] *= 2;
    total -= bins[largest];
    total += bins[largest] = bins_of(maps[largest], factors[largest]);
  }
  return factors;
}

Map reduced(const Map& map, int factor) {
  Map small = map;
  small.width = (map.width + factor - 1) / factor;
  small.height = (map.height + factor - 1) / factor;
  small.standard_error.clear();
  const auto size = static_cast<size_t>(small.width) * static_cast<size_t>(small.height);
  std::vector<double> sum(size, 0.0), count(size, 0.0);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const double value = map.value[static_cast<size_t>(y) * static_cast<size_t>(map.width) +
                                     static_cast<size_t>(x)];
      if (!std::isfinite(value)) continue;
      const auto block = static_cast<size_t>(y / factor) * static_cast<size_t>(small.width) +
                         static_cast<size_t>(x / factor);
      sum[block] += value;
      count[block] += 1.0;
    }
  }
  small.value.assign(size, std::numeric_limits<double>::quiet_NaN());
  for (size_t i = 0; i < size; ++i) {
    if (count[i] > 0.0) small.value[i] = sum[i] / count[i];
  }
  return small;
}

Json page_content(const RunPage& page, const PageLimits& limits) {
  const std::vector<int> factors = map_reductions(page.product.maps, limits.map_bins);
  Json maps = Json::array();
  for (size_t i = 0; i < factors.size(); ++i) {
    maps.push_back(map_content(page.product.maps[i], factors[i]));
  }
  const auto plot = [&](const Plot& one) { return plot_json(one, page, limits); };
  const auto table = [&](const Table& one) { return table_json(one, limits.table_rows); };
  Json provenance = provenance_json(page.provenance);
  if (page.rays) provenance["rays"] = *page.rays;
  Json json = {
      {"schema", "photorque.page/1"},
      {"title", clean_text(page.title)},
      {"verb", clean_text(page.verb)},
      {"command", clean_text(page.command)},
      {"headline", clean_text(page.headline)},
      {"headlines", list_of(page.headlines, figure_json)},
      {"figures", list_of(page.figures, figure_json)},
      {"figures_file", clean_text(page.figures_file)},
      {"power", list_of(page.power, stage_json)},
      {"with_text", page.text.has_value()},
      {"notes", list_of(page.notes, clean_text)},
      {"maps", std::move(maps)},
      {"plots", list_of(page.product.plots, plot)},
      {"tables", list_of(page.product.tables, table)},
      {"colours", {{"viridis", colours_json(viridis())}, {"cool_warm", colours_json(cool_warm())}}},
      {"provenance", std::move(provenance)}};
  if (page.stage) json["stage"] = stage_content(*page.stage, page.product, limits);
  return json;
}

}  // namespace photorque
