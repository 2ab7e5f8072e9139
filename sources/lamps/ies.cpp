// A lamp as its maker measured it: an IES LM-63, IES TM-33 or EULUMDAT file, or a table in the
// experiment.
//
//   [[source]]
//   kind = "ies"
//   file = "lamp.ies"            # or lamp.ldt; beside the experiment
//   power_W = 2.0                # radiant, > 0; the file gives the shape alone
//   wavelength_nm = 730
//   spectral_fwhm_nm = 30        # default 20
//   position_m = [0, 0, 1.5]     # or positions_m = [[…], …]: one lamp at each
//   aim_m = [0, 0, 0]            # or direction = [0, 0, -1]: where the file's nadir (γ = 0) looks
//   turn_deg = 0                 # about the beam, right-handed about its direction
//   aperture_diameter_m = 0.02   # default: the luminous opening of the file
//
// Instead of `file`: polar_deg = [0, 5, …, 90] and intensity = [1, 0.9, …, 0], even round the beam,
// or with azimuth_deg = [0, 90, …] one row of intensities after the other. Such a table needs an
// aperture_diameter_m or is a point.
#include <memory>

#include "core/constants.h"
#include "core/files.h"
#include "sources/lamps/keys.h"
#include "sources/lamps/measured.h"
#include "sources/lamps/photometric.h"
#include "sources/lamps/settings.h"
#include "sources/photometry/planes.h"

namespace photorque::kinds::ies {
namespace {

PhotometricFile read_inline(const Settings& settings) {
  StoredPlanes stored;
  const Range degrees{0.0, pi};
  const std::vector<double> polar_rad = settings.numbers("polar_deg", degrees);
  for (const double angle_rad : polar_rad) stored.polar_deg.push_back(angle_rad / degree_rad);
  require_ascending(stored.polar_deg, settings.name() + ".polar_deg", settings.where());
  stored.azimuth_deg = {0.0};
  if (settings.has("azimuth_deg")) {
    stored.azimuth_deg.clear();
    for (const double angle_rad : settings.numbers("azimuth_deg", {0.0, 2.0 * pi, false, true})) {
      stored.azimuth_deg.push_back(angle_rad / degree_rad);
    }
    require_ascending(stored.azimuth_deg, settings.name() + ".azimuth_deg", settings.where());
  }
  stored.intensity = settings.numbers("intensity", Range::not_negative());
  const size_t expected = stored.polar_deg.size() * stored.azimuth_deg.size();
  if (stored.polar_deg.size() < 2 || stored.intensity.size() != expected) {
    throw settings.error("intensity", std::to_string(stored.intensity.size()) + " numbers",
                         "one for every angle of polar_deg (at least two) and azimuth_deg: " +
                             std::to_string(expected));
  }
  PhotometricFile file;
  file.table = unfold(stored, PlaneSymmetry::none, settings.where());
  require_light(file, settings.where());
  return file;
}

PhotometricFile read_table(const Settings& settings, const SourceContext& context) {
  if (!settings.has("file")) return read_inline(settings);
  const SourceFile source = read_source_file(settings, context);
  return read_photometric(source.bytes, source.name);
}

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.text_or("name", "ies");
  const double power_W = settings.number("power_W", Range::positive());
  PhotometricFile file = read_table(settings, context);
  if (settings.has("aperture_diameter_m")) {
    const double diameter_m = settings.number("aperture_diameter_m", opening_diameter);
    file.opening = {Opening::Shape::ellipse, diameter_m, diameter_m};
  }
  const auto lamp = std::make_shared<PhotometricLamp>(power_W, file.opening,
                                                      TabulatedIntensity(std::move(file.table)));
  if (const auto coarse = coarseness_notice(*lamp)) file.notices.push_back(*coarse);
  for (const std::string& line : file.notices) {
    if (context.notice) context.notice(name + ": " + line);
  }
  return place_lamps(settings, name, lamp, read_line_spectrum(settings, usual_led_width_m),
                     uniform_aperture(*lamp));
}

}  // namespace

SourceKind kind() {
  return {
      "ies",
      "A lamp with a measured intensity: an IES LM-63, IES TM-33 or EULUMDAT file, or a table",
      make,
      {{"polar_deg", {SettingsNode::Array{{0.0}, {5.0}, {10.0}, {20.0}, {40.0}, {90.0}}}},
       {"intensity", {SettingsNode::Array{{1.0}, {0.9}, {0.6}, {0.2}, {0.05}, {0.0}}}},
       {"power_W", {2.0}},
       {"aperture_diameter_m", {0.02}},
       {"wavelength_nm", {730.0}},
       {"position_m", {SettingsNode::Array{{0.0}, {0.0}, {1.5}}}},
       {"direction", {SettingsNode::Array{{0.0}, {0.0}, {-1.0}}}}},
      joined(
          {{source_name_key("ies"),
            Key::text("file",
                      "IES LM-63, IES TM-33 or EULUMDAT; or a table of `polar_deg` and `intensity`")
                .optional(),
            radiant_power_key()},
           line_spectrum_keys(usual_led_width_m),
           lamp_place_keys(),
           {Key::number("aperture_diameter_m", opening_diameter, "of the opening that light leaves")
                .usually_is("the file's; of a table a point"),
            Key::numbers("polar_deg", {0.0, pi}, "instead of `file`: angles from the axis, rising")
                .optional(),
            Key::numbers(
                "azimuth_deg", {0.0, 2.0 * pi, false, true},
                "with `polar_deg`, of a beam that is not round: angles about the axis, rising")
                .optional(),
            Key::numbers("intensity", Range::not_negative(),
                         "one for every angle of `polar_deg`; a row for each of `azimuth_deg`")
                .optional()}})};
}

}  // namespace photorque::kinds::ies
