// LightTools ray data file in text: keywords up to lt_startofdata, then one ray per line, x y z  l
// m n  flux [wavelength].
#include <algorithm>
#include <optional>
#include <set>

#include "core/text/parse.h"
#include "sources/photometry/ray_set.h"

namespace photorque {
namespace {

constexpr double nanometre_m = 1e-9;
constexpr std::string_view blanks = " \t\r\v\f\x1a";

// Numbers are separated by blanks, or by commas without blanks. Commas that follow a number before
// a blank are removed; a decimal comma is an error.
std::vector<std::string_view> numbers_of(std::string_view line) {
  std::vector<std::string_view> words = words_of(line, blanks);
  if (words.size() == 1) return words_of(line, ",");
  for (std::string_view& word : words) {
    if (word.ends_with(',')) word.remove_suffix(1);
  }
  return words;
}

struct LightToolsHeader {
  double metres_per_unit = 1e-3;
  Vec3 origin = Vec3::Zero();  // in the file's unit
  size_t columns = 7;
  std::set<std::string, std::less<>> keys;
};

double number_at(const std::vector<std::string_view>& words, size_t index,
                 const InputLocation& where) {
  return require_number(index < words.size() ? words[index] : "", where,
                        "column " + std::to_string(index + 1));
}

double unit_of(std::string_view name, const InputLocation& where) {
  if (name == "millimeters" || name == "millimetres") return 1e-3;
  if (name == "centimeters" || name == "centimetres") return 1e-2;
  if (name == "meters" || name == "metres") return 1.0;
  if (name == "inches") return 0.0254;
  if (name == "feet") return 0.3048;
  throw InputError(where, "lt_length_units", in_quotes(name),
                   "millimeters, centimeters, meters, inches or feet");
}

double flux_of(std::string_view key, std::string_view value, const InputLocation& where) {
  const std::optional<double> flux = number_in(value.substr(0, value.find_first_of(blanks)));
  if (!flux || !(*flux > 0.0)) {
    throw InputError(where, std::string(key), in_quotes(value), "a number above 0");
  }
  return *flux;
}

void read_keyword(std::string_view line, const InputLocation& where, LightToolsHeader& header,
                  RaySet& set) {
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos) return;
  const std::string_view key = trimmed(line.substr(0, colon));
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (key == "dataname") set.name = std::string(value);
  if (!key.starts_with("lt_")) return;
  if (!header.keys.emplace(key).second) {
    throw InputError(where, std::string(key), "for the second time", "each keyword once");
  }
  if (key == "lt_length_units") header.metres_per_unit = unit_of(value, where);
  if (key == "lt_datatype" && value.find("luminous") != std::string_view::npos) {
    set.flux_unit = RaySet::FluxUnit::lumen;
  }
  if (key == "lt_data_origin") {
    const std::vector<std::string_view> words = numbers_of(value);
    for (int k = 0; k < 3; ++k) header.origin[k] = number_at(words, static_cast<size_t>(k), where);
  }
  if (key == "lt_color_info" && value == "wavelength") header.columns = 8;
  if (key == "lt_radiant_flux") set.stated_radiant_flux_W = flux_of(key, value, where);
  if (key == "lt_luminous_flux") set.stated_luminous_flux_lm = flux_of(key, value, where);
}

RaySet::Ray read_ray(std::string_view line, const LightToolsHeader& header,
                     const InputLocation& where) {
  const std::vector<std::string_view> words = numbers_of(line);
  RaySet::Ray ray;
  for (int k = 0; k < 3; ++k) {
    ray.origin_m[k] = header.metres_per_unit *
                      (header.origin[k] + number_at(words, static_cast<size_t>(k), where));
    ray.direction[k] = number_at(words, static_cast<size_t>(k) + 3, where);
  }
  ray.flux = number_at(words, 6, where);
  if (header.columns == 8)
    ray.wavelength_m = std::max(0.0, nanometre_m * number_at(words, 7, where));
  return ray;
}

}  // namespace

RaySet read_lighttools_rays(const std::string& bytes, const std::string& name) {
  RaySet set;
  set.format = "LightTools";
  LightToolsHeader header;
  bool in_data = false;
  DataLines lines(bytes, name);
  for (std::string_view text; lines.next(text);) {
    const InputLocation& where = lines.where();
    if (text == "lt_endofdata") break;
    if (in_data) {
      set.rays.push_back(read_ray(text, header, where));
      require_sound(set.rays.back(), set.rays.size() - 1, where);
    } else if (text == "lt_startofdata") {
      if (!header.keys.contains("lt_length_units")) {
        throw InputError(where, "lt_length_units", "no such line before the rays",
                         "millimeters, centimeters, meters, inches or feet");
      }
      in_data = true;
    } else {
      read_keyword(text, where, header, set);
    }
  }
  require_flux(set, lines.where());
  return set;
}

}  // namespace photorque
