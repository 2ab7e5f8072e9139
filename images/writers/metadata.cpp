#include "images/writers/metadata.h"

#include "core/text/format.h"
#include "images/drawing/map.h"

namespace photorque {
namespace {

std::vector<float> top_row_first(const Map& map, const std::vector<double>& values) {
  std::vector<float> samples;
  samples.reserve(values.size());
  for (int iy = map.height - 1; iy >= 0; --iy) {
    const auto row = values.begin() + static_cast<ptrdiff_t>(iy) * map.width;
    std::transform(row, row + map.width, std::back_inserter(samples),
                   [](double value) { return static_cast<float>(value); });
  }
  return samples;
}

}  // namespace

using Json = nlohmann::ordered_json;

Json provenance_json(const Provenance& provenance) {
  Json inputs = Json::object();
  for (const auto& [file, hash] : provenance.inputs) inputs[clean_text(file)] = clean_text(hash);
  Json json = {{"program", clean_text(provenance.program)},
               {"version", clean_text(provenance.version)},
               {"git_hash", clean_text(provenance.git_hash)},
               {"seed", provenance.seed},
               {"inputs", inputs}};
  for (const std::string& warning : provenance.warnings) {
    json["warnings"].push_back(clean_text(warning));
  }
  return json;
}

std::string ascii_line(const Json& json) {
  return json.dump(-1, ' ', true);
}

std::vector<ImageChannel> map_channels(const Map& map) {
  require_consistent(map);
  std::vector<float> errors(map.value.size(), 0.0F);
  if (!map.standard_error.empty()) errors = top_row_first(map, map.standard_error);
  return {{"value", top_row_first(map, map.value)}, {"standard_error", std::move(errors)}};
}

ImageMetadata map_metadata(const Map& map, const Provenance& provenance) {
  const Json description = {{"name", clean_text(map.name)},
                            {"title", clean_text(map.title)},
                            {"unit", clean_text(map.unit)},
                            {"x_label", clean_text(map.x_label)},
                            {"y_label", clean_text(map.y_label)},
                            {"x_low", map.x_low},
                            {"x_high", map.x_high},
                            {"y_low", map.y_low},
                            {"y_high", map.y_high},
                            {"rows", "top row is the largest y"},
                            {"provenance", provenance_json(provenance)}};
  const std::string inputs = joined_text(provenance.inputs, " ", [&](const auto& item) {
    const auto& [file, hash] = item;
    return file + ":" + hash;
  });
  return {.description = ascii_line(description),
          .title = clean_text(map.title),
          .program = clean_text(provenance.program + " " + provenance.version),
          .texts = {{"photorque:unit", clean_text(map.unit)},
                    {"photorque:x_label", clean_text(map.x_label)},
                    {"photorque:y_label", clean_text(map.y_label)},
                    {"photorque:rows", "top row is the largest y"},
                    {"photorque:version", clean_text(provenance.version)},
                    {"photorque:git_hash", clean_text(provenance.git_hash)},
                    {"photorque:seed", std::to_string(provenance.seed)},
                    {"photorque:inputs", clean_text(inputs)}},
          .numbers = {{"photorque:x_low", map.x_low},
                      {"photorque:x_high", map.x_high},
                      {"photorque:y_low", map.y_low},
                      {"photorque:y_high", map.y_high}}};
}

ImageMetadata picture_metadata(const std::string& title, const Provenance& provenance) {
  const nlohmann::ordered_json description = {{"title", clean_text(title)},
                                              {"provenance", provenance_json(provenance)}};
  return {.description = ascii_line(description),
          .title = clean_text(title),
          .program = clean_text(provenance.program + " " + provenance.version)};
}

}  // namespace photorque
