// IES TM-33 (2018, 2022), published before as ATLA S001: luminaires in XML. Element names and units
// from the schema in section 4.7 of ATLA S001-A and in TM-33-22, version 1.1.
#include <algorithm>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <set>

#include "core/text/parse.h"
#include "sources/photometry/file.h"

namespace photorque {
namespace {

constexpr const char* standard_roots = "<IESTM33-22>, <IESTM33-18> or <ATLA_S001_A>";

class XmlText {
 public:
  XmlText(const std::string& bytes, const std::string& name) : name_(name) {
    for (size_t i = 0; i < bytes.size(); ++i) {
      if (bytes[i] == '\n') line_ends_.push_back(static_cast<std::ptrdiff_t>(i));
    }
  }

  InputLocation at(std::ptrdiff_t offset) const {
    const auto before = std::ranges::lower_bound(line_ends_, offset) - line_ends_.begin();
    return {name_, 1 + static_cast<int>(before)};
  }
  InputLocation at(const pugi::xml_node& node) const { return at(node.offset_debug()); }

 private:
  const std::string& name_;
  std::vector<std::ptrdiff_t> line_ends_;  // rising
};

// Some manufacturers' schemas contain blanks at line breaks of the standard's text: "Symm _ Bi _
// 0".
std::string without_blanks(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; });
  return text;
}

std::string on_one_line(const char* text) {
  std::string line(trimmed(text));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  return line;
}

double number_of(const XmlText& text, const pugi::xml_node& node, const std::string& key,
                 const char* value) {
  return require_number(trimmed(value), text.at(node), key);
}

double child_number_or(const XmlText& text, const pugi::xml_node& node, const char* key,
                       double other) {
  const pugi::xml_node child = node.child(key);
  return child ? number_of(text, child, key, child.child_value()) : other;
}

// Kinds of intensity in the standard, most similar to watts first.
struct IntensityKind {
  const char *data, *intensity, *words;
};
constexpr IntensityKind intensity_kinds[] = {
    {"RadiantData", "RadiantIntensity", "radiant intensity"},
    {"PhotonData", "PhotonIntensity", "photon intensity"},
    {"LuminousData", "LuminousIntensity", "luminous intensity"},
};

struct Found {
  pugi::xml_node emitter, intensity;
  const char* words = "";
};

Found find_intensity(const XmlText& text, const pugi::xml_node& root) {
  Found found;
  for (const pugi::xml_node& emitter : root.children("Emitter")) {
    for (const IntensityKind& kind : intensity_kinds) {
      const pugi::xml_node intensity = emitter.child(kind.data).child(kind.intensity);
      if (!intensity) continue;
      if (found.emitter) {
        throw InputError(text.at(emitter), "Emitter", "a second one with intensities",
                         "one: a separate file for each emitter");
      }
      found = {emitter, intensity, kind.words};
      break;
    }
  }
  if (!found.emitter) {
    throw InputError(text.at(root), "Emitter", "none with a table of intensities",
                     "RadiantIntensity, PhotonIntensity or LuminousIntensity");
  }
  return found;
}

// Values at (horizontal, vertical) in degrees.
using DirectionValues = std::map<std::pair<double, double>, double>;

DirectionValues read_values(const XmlText& text, const pugi::xml_node& intensity) {
  DirectionValues values;
  const double factor = child_number_or(text, intensity, "Multiplier", 1.0);
  for (const pugi::xml_node& node : intensity.children("IntData")) {
    std::array<double, 2> angles_deg{};
    for (const size_t k : {0u, 1u}) {
      const char* key = k == 0 ? "h" : "v";
      const pugi::xml_attribute angle = node.attribute(key);
      if (!angle) {
        throw InputError(text.at(node), "IntData", std::string("no attribute ") + key,
                         "angles h and v in degrees");
      }
      angles_deg[k] = number_of(text, node, key, angle.value());
    }
    const double value = factor * number_of(text, node, "IntData", node.child_value());
    if (!std::isfinite(value)) {
      throw InputError(text.at(node), "IntData", "a number that overflows", "a finite intensity");
    }
    if (!values.emplace(std::pair(angles_deg[0], angles_deg[1]), value).second) {
      throw InputError(text.at(node), "IntData",
                       "h " + shortest(angles_deg[0]) + ", v " + shortest(angles_deg[1]) + " twice",
                       "every direction once");
    }
  }
  return values;
}

void require_count(const XmlText& text, const pugi::xml_node& intensity, const char* key,
                   size_t counted) {
  const pugi::xml_node node = intensity.child(key);
  if (!node || number_of(text, node, key, node.child_value()) == static_cast<double>(counted)) {
    return;
  }
  throw InputError(text.at(node), key, on_one_line(node.child_value()),
                   std::to_string(counted) + ", as many as there are in IntData");
}

StoredPlanes planes_of(const XmlText& text, const pugi::xml_node& intensity) {
  const DirectionValues values = read_values(text, intensity);
  std::set<double> horizontal_deg, vertical_deg;
  for (const auto& [angles_deg, value] : values) {
    horizontal_deg.insert(angles_deg.first);
    vertical_deg.insert(angles_deg.second);
  }
  require_count(text, intensity, "NumberMeasured", values.size());
  require_count(text, intensity, "NumberHorz", horizontal_deg.size());
  require_count(text, intensity, "NumberVert", vertical_deg.size());
  if (vertical_deg.size() < 2) {
    throw InputError(text.at(intensity), "IntData",
                     std::to_string(vertical_deg.size()) + " vertical angles", "at least two");
  }
  StoredPlanes stored{{horizontal_deg.begin(), horizontal_deg.end()},
                      {vertical_deg.begin(), vertical_deg.end()},
                      {}};
  for (const double h_deg : horizontal_deg) {
    for (const double v_deg : vertical_deg) {
      const auto value = values.find({h_deg, v_deg});
      if (value == values.end()) {
        throw InputError(text.at(intensity), "IntData",
                         "none at h " + shortest(h_deg) + ", v " + shortest(v_deg),
                         "every vertical angle in every plane");
      }
      stored.intensity.push_back(value->second);
    }
  }
  return stored;
}

PlaneSymmetry stated_symmetry(const XmlText& text, const pugi::xml_node& intensity,
                              const StoredPlanes& stored) {
  const pugi::xml_node node = intensity.child("Symm");
  if (!node) return implied_symmetry(stored.azimuth_deg);
  const std::string symmetry = without_blanks(node.child_value());
  if (symmetry == "Symm_Full" && stored.azimuth_deg.size() > 1) {
    throw InputError(text.at(node), "Symm",
                     "Symm_Full with " + std::to_string(stored.azimuth_deg.size()) + " planes",
                     "one plane, which stands for all");
  }
  if (symmetry == "Symm_None" || symmetry == "Symm_Full") return PlaneSymmetry::none;
  if (symmetry == "Symm_Bi_0") return PlaneSymmetry::across_0_180;
  if (symmetry == "Symm_Bi_90") return PlaneSymmetry::across_90_270;
  if (symmetry == "Symm_Quad") return PlaneSymmetry::both;
  throw InputError(text.at(node), "Symm", "\"" + symmetry.substr(0, 24) + "\"",
                   "Symm_None, Symm_Bi_0, Symm_Bi_90, Symm_Quad or Symm_Full");
}

Pole pole_of(const XmlText& text, const pugi::xml_node& root) {
  const pugi::xml_node node = root.child("Equipment").child("Gonioradiometer").child("Type");
  const std::string type = without_blanks(node.child_value());
  if (!node || type == "CIE_C" || type == "IES_C") return Pole::beam;
  if (type == "CIE_A" || type == "IES_A") return Pole::vertical;
  if (type == "CIE_B" || type == "IES_B") return Pole::horizontal;
  throw InputError(text.at(node), "Type", "\"" + type.substr(0, 24) + "\"",
                   "CIE_A, CIE_B, CIE_C, IES_A, IES_B or IES_C");
}

// Lengths lie along C90 and widths along C0, in metres.
Opening opening_of(const XmlText& text, const pugi::xml_node& emitter, PhotometricFile& file) {
  const pugi::xml_node areas = emitter.child("EmissionAreas");
  const pugi::xml_node face = areas.child("BottomFace");
  Opening opening;
  size_t faces = 0, pieces = 0;
  for ([[maybe_unused]] const pugi::xml_node& any : areas.children()) ++faces;
  bool circular = false;
  for (const pugi::xml_node& area : face.children("BottomArea")) {
    const auto reach_m = [&](const char* size, const char* offset) {
      return std::abs(child_number_or(text, area, size, 0.0)) +
             2.0 * std::abs(child_number_or(text, area, offset, 0.0));
    };
    opening.x_m = std::max(opening.x_m, reach_m("Width", "WidthOffset"));
    opening.y_m = std::max(opening.y_m, reach_m("Length", "LengthOffset"));
    const std::string_view round = trimmed(area.child_value("Circular"));
    circular = round == "true" || round == "1";
    ++pieces;
  }
  if (faces > (face ? 1u : 0u)) {
    file.notices.emplace_back(pieces > 0
                                  ? "only the bottom face emits light; the other faces are ignored"
                                  : "no luminous area on the bottom face: the source is a point");
  }
  if (pieces > 1) {
    file.notices.push_back(std::to_string(pieces) +
                           " luminous areas count as the rectangle about them");
  }
  if (opening.x_m > 0.0 || opening.y_m > 0.0) {
    opening.shape = circular && pieces == 1 ? Opening::Shape::ellipse : Opening::Shape::rectangle;
  }
  return opening;
}

void read_header(const pugi::xml_node& root, PhotometricFile& file) {
  constexpr std::pair<const char*, const char*> keywords[] = {
      {"ReportNumber", "TEST"},    {"Laboratory", "TESTLAB"},   {"ReportDate", "ISSUEDATE"},
      {"Manufacturer", "MANUFAC"}, {"CatalogNumber", "LUMCAT"}, {"Description", "LUMINAIRE"},
  };
  for (const auto& [element, keyword] : keywords) {
    const std::string text = on_one_line(root.child("Header").child_value(element));
    if (!text.empty()) file.labels.emplace_back(keyword, text);
  }
}

}  // namespace

PhotometricFile read_tm33(const std::string& bytes, const std::string& name) {
  const XmlText text(bytes, name);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(bytes.data(), bytes.size());
  if (!parsed) {
    throw InputError(text.at(parsed.offset), "XML", parsed.description(), "well-formed XML");
  }
  const pugi::xml_node root = document.document_element();
  const std::string root_name = root.name();
  if (!root_name.starts_with("IESTM33") && !root_name.starts_with("ATLA_S001")) {
    throw InputError(text.at(root), "XML", "<" + root_name.substr(0, 40) + ">", standard_roots);
  }
  PhotometricFile file;
  file.format = root_name;
  read_header(root, file);
  const Found found = find_intensity(text, root);
  file.input_power_W = child_number_or(text, found.emitter, "InputWattage", 0.0);
  const pugi::xml_node flux = found.intensity.parent().child("LuminousFlux");
  if (flux) file.stated_flux_lm = number_of(text, flux, "LuminousFlux", flux.child_value());
  if (found.emitter.child("TiltAngles")) {
    file.notices.emplace_back("tilt factors (a lamp that dims when tilted) are not applied");
  }
  file.opening = opening_of(text, found.emitter, file);
  StoredPlanes stored = planes_of(text, found.intensity);
  const InputLocation where = text.at(found.intensity);
  require_opening(file.opening, where);
  const Pole pole = pole_of(text, root);
  if (pole == Pole::beam) {
    require_goniometer_range(stored.polar_deg, where);
    const PlaneSymmetry symmetry = stated_symmetry(text, found.intensity, stored);
    file.table = unfold(stored, symmetry, where);
  } else {
    // Angles that start at 0 are mirrored to both sides, as in LM-63.
    const pugi::xml_node symmetry = found.intensity.child("Symm");
    const bool one_sided = stored.polar_deg.front() == 0.0 || stored.azimuth_deg.front() == 0.0;
    if (one_sided && without_blanks(symmetry.child_value()) == "Symm_None") {
      throw InputError(text.at(symmetry), "Symm", "Symm_None with angles from 0",
                       "angles on both sides, for types A and B");
    }
    file.table = sideways_table(pole, stored, where);
  }
  require_light(file, where);
  note_gaps(file);
  return file;
}

}  // namespace photorque
