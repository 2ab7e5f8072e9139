// Lamps of a glTF file: position and cone (KHR_lights_punctual), or photometric file
// (EXT_lights_ies).
//
// Their intensity (candela, lux) is meant for rendering and is not read: the experiment states
// radiant power and wavelength.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "core/transform.h"
#include "scenes/gltf/reader.h"

namespace photorque {

// A lamp in the lab frame, for the platform at zero tilt.
struct GltfLight {
  enum class Kind { point, spot, directional, profile };
  std::string name;  // of its node, else of the light, else "light_3"
  Kind kind = Kind::point;
  Vec3 position_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  // direction of emission; not used for a point
  double outer_cone_rad = 0.0;      // of a spot: half-angle of its cone
  // For a light profile: the name of the IES file in messages, its content, and the rotation about
  // `direction` of a lamp placed by place_lamps() that turns its C0 to the node's x.
  std::string profile_name, profile_bytes;
  double turn_rad = 0.0;
};

// Lights in the order of the nodes. Throws InputError like read_gltf(), and for lights that violate
// the extension.
std::vector<GltfLight> read_gltf_lights(const std::filesystem::path& path, double metres_per_unit,
                                        bool may_leave_folder = false);

// Reads lights from bytes; messages call them `file`.
std::vector<GltfLight> read_gltf_lights_bytes(const std::string& bytes, const std::string& file,
                                              const GltfOpen& open, double metres_per_unit,
                                              uint64_t largest_bytes = 4ull << 30);

// Completes a `[[source]]` that names a light, `light = "NAME"`. Adds those of the following keys
// that the user has not given: position_m; direction (not for a point); kind (spot: "led",
// directional: "sun", profile: "ies"); for a spot as LED without `profile`, a uniform cone; for a
// profile, `file` and turn_rad. Throws InputError for a name that matches no light or several.
Settings source_at_light(const Settings& source, const std::vector<GltfLight>& lights);

// Bytes of the profile to which a source's key `file` refers, if it belongs to one of the lights.
std::optional<std::string> profile_of_lights(const std::vector<GltfLight>& lights,
                                             const std::string& file);

}  // namespace photorque
