#include "images/writers/metadata.h"

#include "core/text/format.h"

namespace photorque {

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

Json map_json(const Map& map, const Provenance& provenance) {
  return {{"name", clean_text(map.name)},
          {"title", clean_text(map.title)},
          {"unit", clean_text(map.unit)},
          {"x_label", clean_text(map.x_label)},
          {"y_label", clean_text(map.y_label)},
          {"x_low", json_number(map.x_low)},
          {"x_high", json_number(map.x_high)},
          {"y_low", json_number(map.y_low)},
          {"y_high", json_number(map.y_high)},
          {"rows", "top row is the largest y"},
          {"provenance", provenance_json(provenance)}};
}

std::string ascii_line(const Json& json) {
  return json.dump(-1, ' ', true);
}

Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace photorque
