// The keys that several kinds of source share, as they are declared; settings.h and ray_file.h read
// them.
#pragma once

#include <vector>

#include "core/constants.h"
#include "core/settings/keys.h"

namespace photorque {

// `name`, with the kind for a default.
Key source_name_key(const std::string& kind);
// The radiant power of one lamp.
Key radiant_power_key();
Key source_position_key(const std::string& what);
// read_direction(), and `direction` alone.
std::vector<Key> direction_keys();
Key direction_key(const std::string& what);
// read_line_spectrum().
std::vector<Key> line_spectrum_keys(double default_fwhm_m);
// read_sunlight().
std::vector<Key> sunlight_keys();
// read_lamp().
std::vector<Key> lamp_keys();
// place_lamps().
std::vector<Key> lamp_place_keys();

// Of what light leaves and how wide it spreads. No optics are smaller; far below, squares of them
// are no numbers any more, or lie between the roundings of the distances.
constexpr Range opening_diameter{1e-12, 1e308, false, false};
constexpr Range beam_width{1e-12 * degree_rad, pi, false, true};
constexpr Range beam_half_angle{1e-12 * degree_rad, 0.5 * pi, false, false};

constexpr double usual_led_width_m = 20e-9;  // spectral_fwhm_nm of LEDs

}  // namespace photorque
