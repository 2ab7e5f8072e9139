// A lamp as a file of rays: IES TM-25, Zemax binary or LightTools text.
//
//   [[source]]
//   kind = "ray_file"
//   file = "lamp.tm25ray"        # beside the experiment
//   power_W = 2.0                # radiant; default: the file's, if it states one
//   wavelength_nm = 730          # default: the file's, if it states one
//   spectral_fwhm_nm = 30        # default 20
//   position_m = [0, 0, 1.5]     # of the file's origin; or positions_m = [[…], …]
//   aim_m = [0, 0, 0]            # or direction = [0, 0, -1]: where the file's z axis looks
//   turn_deg = 0                 # about the beam, right-handed about its direction
//
// The fluxes of the rays are scaled to the power: their sum is often of another scale than the flux
// that the file states, which is said.
#include <cmath>
#include <cstdio>
#include <memory>

#include "sources/lamps/keys.h"
#include "sources/lamps/measured.h"
#include "sources/lamps/rays.h"
#include "sources/lamps/settings.h"

namespace photorque::kinds::ray_file {
namespace {

std::string sum_notice(const RaySet& set) {
  const bool watts = set.flux_unit == RaySet::FluxUnit::watt;
  const std::optional<double>& stated =
      watts ? set.stated_radiant_flux_W : set.stated_luminous_flux_lm;
  const double sum = set.ray_flux();
  constexpr double rounding = 1e-4;
  if (!stated || std::abs(sum - *stated) <= rounding * *stated) return "";
  char text[160];
  std::snprintf(text, sizeof text,
                "the fluxes of its rays sum to %.6g %s, the file states %.6g %s; "
                "they are scaled by %.6g",
                sum, watts ? "W" : "lm", *stated, watts ? "W" : "lm", *stated / sum);
  return text;
}

double read_power(const Settings& settings, const RaySet& set) {
  if (settings.has("power_W")) return settings.number("power_W", Range::positive());
  if (set.stated_radiant_flux_W) return *set.stated_radiant_flux_W;
  throw settings.error("power_W", "nothing, and a file without radiant flux", "a power in watts");
}

Spectrum read_spectrum(const Settings& settings, const RaySet& set, std::string& notice) {
  if (settings.has("wavelength_nm")) return read_line_spectrum(settings, usual_led_width_m);
  double flux = 0.0, moment = 0.0;
  for (const RaySet::Ray& ray : set.rays) {
    if (!(ray.wavelength_m > 0.0)) continue;
    flux += ray.flux;
    moment += ray.flux * ray.wavelength_m;
  }
  if (flux > 0.0) notice = "wavelengths of single rays are replaced by their mean";
  if (!(flux > 0.0) && !set.wavelength_m) {
    throw settings.error("wavelength_nm", "nothing, and a file without wavelength", "a wavelength");
  }
  Spectrum spectrum;
  spectrum.centre_m = flux > 0.0 ? moment / flux : *set.wavelength_m;
  spectrum.fwhm_m = settings.number_or("spectral_fwhm_nm", usual_led_width_m, {0.0, 1e-3});
  return spectrum;
}

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.text_or("name", "ray_file");
  const SourceFile source = read_source_file(settings, context);
  const RaySet set = read_rays(source.bytes, source.name);
  const double power_W = read_power(settings, set);
  std::string wavelengths;
  const Spectrum spectrum = read_spectrum(settings, set, wavelengths);
  const std::string noise = std::to_string(set.rays.size()) +
                            " rays; the noise of the file itself is not in the standard errors";
  for (const std::string& line : {sum_notice(set), wavelengths, noise}) {
    if (context.notice && !line.empty()) context.notice(name + ": " + line);
  }
  return place_lamps(settings, name, std::make_shared<RayLamp>(power_W, set), spectrum);
}

}  // namespace

SourceKind kind() {
  return {
      "ray_file",
      "A lamp as a file of rays: IES TM-25, Zemax binary or LightTools text",
      make,
      {{"file", {"lamp.tm25ray"}},
       {"power_W", {2.0}},
       {"wavelength_nm", {730.0}},
       {"position_m", {SettingsNode::Array{{0.0}, {0.0}, {1.5}}}},
       {"direction", {SettingsNode::Array{{0.0}, {0.0}, {-1.0}}}}},
      joined({{source_name_key("ray_file"),
               Key::text("file", "IES TM-25, Zemax binary or LightTools text"),
               radiant_power_key().usually_is("the file's")},
              {Key::number("wavelength_nm", {1e-8, 1e-3}, "middle of the spectrum")
                   .usually_is("the file's"),
               Key::number_or("spectral_fwhm_nm", usual_led_width_m, {0.0, 1e-3},
                              "full width at half maximum of the spectrum, a Gaussian; 0: a line")},
              lamp_place_keys()})};
}

}  // namespace photorque::kinds::ray_file
