// The keys that several kinds of source share; settings.h reads them.
#pragma once

#include "core/constants.h"
#include "core/settings/typed_keys.h"

namespace photorque {

// Lower limits of apertures and beam widths, below those of real optics. Far smaller values have
// squares that underflow or are smaller than the rounding errors of distances.
inline constexpr Range opening_diameter{1e-12, 1e308, false, false};
inline constexpr Range beam_width{1e-12 * degree_rad, pi, false, true};
inline constexpr Range beam_half_angle{1e-12 * degree_rad, 0.5 * pi, false, false};

inline constexpr double usual_led_width_m = 20e-9;  // default spectral_fwhm_nm of LEDs

namespace source_key {
inline constexpr TextKey name("name", "name in results and messages");  // default: the kind
inline constexpr NumberKey power("power_W", Range::positive(), "radiant power of each lamp");
// A kind may replace the description with its own meaning of the point.
inline constexpr Vec3Key position("position_m", "of the lamp, lab axes");
inline constexpr Vec3Key direction("direction",
                                   "direction of the beam, lab axes, any length; or `aim_m`",
                                   {.optional = true});
inline constexpr Vec3Key aim("aim_m", "instead of `direction`: a point on the axis of the beam",
                             {.optional = true});
inline constexpr NumberKey wavelength("wavelength_nm", {1e-8, 1e-3},
                                      "centre wavelength of the spectrum");
inline constexpr NumberKey spectral_fwhm(
    "spectral_fwhm_nm", usual_led_width_m, {0.0, 1e-3},
    "full width at half maximum of the Gaussian spectrum; 0: a single line");
inline constexpr NumberKey aperture_diameter("aperture_diameter_m", opening_diameter,
                                             "diameter of the emitting aperture");

// Direction of light from a distant source.
inline constexpr Vec3Key light_direction("direction",
                                         "direction of the light, lab axes, any length");
}  // namespace source_key

// Keys of read_sunlight().
std::vector<Key> sunlight_keys();
// Keys of read_lamp().
std::vector<Key> lamp_keys();
// Keys of place_lamps().
std::vector<Key> lamp_place_keys();

}  // namespace photorque
