#include "sources/lamps/keys.h"

#include "core/constants.h"

namespace photorque {
namespace {

Key fwhm_key() {
  return Key::number("fwhm_deg", beam_width, "full width at half of the maximum intensity");
}

}  // namespace

Key source_name_key(const std::string& kind) {
  return Key::text_or("name", kind, "names results and messages");
}

Key radiant_power_key() {
  return Key::number("power_W", Range::positive(), "radiant power");
}

Key source_position_key(const std::string& what) {
  return Key::vector3("position_m", what);
}

Key direction_key(const std::string& what) {
  return Key::vector3("direction", what);
}

std::vector<Key> direction_keys() {
  return {direction_key("where it looks, lab axes, any length; or `aim_m`").optional(),
          Key::vector3("aim_m", "instead of `direction`: the point that it looks at").optional()};
}

std::vector<Key> line_spectrum_keys(double default_fwhm_m) {
  return {Key::number("wavelength_nm", {1e-8, 1e-3}, "middle of the spectrum"),
          Key::number_or("spectral_fwhm_nm", default_fwhm_m, {0.0, 1e-3},
                         "full width at half maximum of the spectrum, a Gaussian; 0: a line")};
}

std::vector<Key> sunlight_keys() {
  return {Key::choice_or("spectrum",
                         {{"blackbody",
                           "Planck's law",
                           {Key::number_or("temperature_K", solar_temperature_K,
                                           {100.0, 1e6, false, false}, "of the black body")}},
                          {"AM0", "above the atmosphere, ASTM G173-03, 280 to 4000 nm"},
                          {"AM1.5G", "on the ground, ASTM G173-03, 280 to 4000 nm"}},
                         0, "what it shines with"),
          Key::number_or("irradiance_W_m2", solar_irradiance_W_m2, Range::positive(),
                         "on a plane normal to the light")
              .usually_is("1361; with `AM1.5G` 1000")};
}

std::vector<Key> lamp_keys() {
  return joined(
      {{Key::number("aperture_diameter_m", opening_diameter, "of the opening that light leaves"),
        Key::choice(
            "profile",
            {{"gaussian", "exp(−4 ln 2 θ²/fwhm²)", {fwhm_key()}},
             {"super_gaussian",
              "exp(−ln 2 (2θ/fwhm)^order)",
              {fwhm_key(), Key::number("order", {2.0, 100.0, false, false},
                                       "2 is a Gaussian, 100 nearly a disc")}},
             {"pillbox",
              "constant to the edge",
              {Key::number("half_angle_deg", beam_half_angle, "from axis to edge"),
               Key::choice("pillbox_measure", words({"angle", "solid_angle", "projected"}),
                           "over what the flux is even")}},
             {"cosine_power",
              "cosᵐ θ",
              {Key::number("exponent", {0.0, 1e9, false, false}, "m; 1 is Lambert's law")}}},
            "how the radiant intensity, per solid angle, falls with the angle θ from the axis"),
        Key::number("halo_fraction", {0.0, 1.0, false, true},
                    "part of the flux in a wider Gaussian; with `halo_fwhm_deg`")
            .usually_is("no halo"),
        Key::number("halo_fwhm_deg", beam_width, "of that Gaussian").optional()},
       line_spectrum_keys(usual_led_width_m),
       {Key::number("die_size_m", Range::positive(),
                    "edge of the square that emits: warns of a beam that no optics can make")
            .optional(),
        Key::number("die_diameter_m", Range::positive(), "the same of a round one").optional(),
        Key::number_or("lens_index", 1.0, {1.0, 5.0, false, false},
                       "refractive index around the die")}});
}

std::vector<Key> lamp_place_keys() {
  return joined(
      {{source_position_key("of the lamp, lab axes; or `positions_m`").optional(),
        Key::vectors3("positions_m", "one lamp at each, instead of `position_m`").optional()},
       direction_keys(),
       {Key::number_or("turn_deg", 0.0, {}, "about the beam, right-handed about its direction")}});
}

}  // namespace photorque
