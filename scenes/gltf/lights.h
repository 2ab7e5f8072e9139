// Lamps of a glTF file: position and cone (KHR_lights_punctual), or the photometric file
// (EXT_lights_ies).
//
// Their intensity (candela, lux) is for pictures and not read: the experiment states radiant power
// and wavelength.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "core/transform.h"
#include "scenes/gltf/reader.h"

namespace photorque {

// A lamp in the lab frame, as in the file with the platform at zero tilt.
struct GltfLight {
  enum class Kind { point, spot, directional, profile };
  std::string name;  // of its node, else of the light, else "light_3"
  Kind kind = Kind::point;
  Vec3 position_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  // in which it shines; not of a point
  double outer_cone_rad = 0.0;      // of a spot: half the angle of its cone
  // A light profile: the name of the IES file in messages, its content, and the rotation of a lamp
  // placed by place_lamps() about `direction` that turns its C0 to the node's x.
  std::string profile_name, profile_bytes;
  double turn_rad = 0.0;
};

// The lights in the order of the nodes. Throws InputError as read_gltf() does, and for lights that
// violate the extension.
std::vector<GltfLight> read_gltf_lights(const std::filesystem::path& path, double metres_per_unit,
                                        bool may_leave_folder = false);

// Reads lights from bytes; messages call them `file`.
std::vector<GltfLight> read_gltf_lights_bytes(const std::string& bytes, const std::string& file,
                                              const GltfOpen& open, double metres_per_unit,
                                              uint64_t largest_bytes = 4ull << 30);

// A `[[source]]` that names one of them, `light = "NAME"`, with its place written out as keys, in
// so far as the user has not given them: position_m; direction, but of a point; kind (spot: "led",
// directional: "sun", profile: "ies"); of a spot that is to be an LED, without `profile`, an even
// cone; of a profile `file` and turn_rad. Throws InputError for a name that none or several have.
Settings source_at_light(const Settings& source, const std::vector<GltfLight>& lights);

// The bytes of the profile that a source's key `file` means, if it is one of the lights'.
std::optional<std::string> profile_of_lights(const std::vector<GltfLight>& lights,
                                             const std::string& file);

}  // namespace photorque
