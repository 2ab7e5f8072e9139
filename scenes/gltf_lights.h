// Lamps that a glTF file places (KHR_lights_punctual): where they stand and how wide they shine.
//
// Their intensity is for pictures (candela, lux) and is not read: what a lamp radiates, and at
// which wavelength, the experiment says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/settings.h"
#include "core/vector.h"

namespace photorque {

// As the file shows it, with the platform at zero tilt: lab frame.
struct GltfLight {
  enum class Kind { point, spot, directional };
  std::string name;  // of its node, else of the light, else "light_3"
  Kind kind = Kind::point;
  Vec3 position_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  // in which it shines; not of a point
  double outer_cone_rad = 0.0;      // of a spot: half the angle of its cone
};

// In the order of the nodes. Throws InputError as read_gltf() does, and for lights that are not as
// the extension says.
std::vector<GltfLight> read_gltf_lights(const std::filesystem::path& path, double metres_per_unit);

// A `[[source]]` that names one of them, `light = "NAME"`, with its place written out as keys, in
// so far as the user has not given them: position_m, of spot and directional lights direction; kind
// (spot: "led", directional: "sun"); of a spot that is to be an LED, without `profile`, an even
// cone. Throws InputError for a name that none or several have.
Settings source_at_light(const Settings& source, const std::vector<GltfLight>& lights);

}  // namespace photorque
