// Optical properties of the materials of a glTF document.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "core/settings/settings.h"
#include "scenes/gltf/file/document.h"
#include "scenes/gltf/reader.h"
#include "scenes/surfaces/settings.h"

namespace photorque::gltf {

// Rec. 709 luminance of linear red, green and blue.
inline double luminance(std::span<const double> rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

struct MaterialOptics {
  SheetOptics sheet;
  OpticsOrigin origin = OpticsOrigin::derived;
};

// Materials of an experiment, by name.
using MaterialOverrides = std::map<std::string, SheetOptics>;

// Reads all [[material]] tables of the experiment, including those of unused materials. Throws
// InputError like read_sheet(), for a repeated name, and for a name that no material of the
// document has (with the most similar one).
MaterialOverrides read_overrides(const Document& document, const GltfOptions& options,
                                 const SurfaceFiles& files);

// Optics of material `index` (−1: the specification's default for primitives without material),
// from the first of:
//   1. an override of the same name;
//   2. the material's extras: {"photorque": {"absorptance": 0.9, …}}, keys as in read_sheet();
//   3. the values meant for drawing, by the rule of derived_surface().
// Throws InputError like read_sheet(), and for unknown keys in extras.photorque.
MaterialOptics material_optics(const Document& document, int index, int bands,
                               const MaterialOverrides& overrides, const SurfaceFiles& files);

// Grey fractions from a material's drawing values, the same in all bands and on both sides. With
// Y the luminance of the base colour (0.2126 R + 0.7152 G + 0.0722 B of its linear factors, IEC
// 61966-2-1), m metallic, r roughness, t transmission factor (KHR_materials_transmission) and
// F0 = ((n − 1)/(n + 1))² with n = 1.5 or from KHR_materials_ior (appendix B of the specification):
//   reflected at the surface   R = (1 − m) F0 + m Y,   a fraction 1 − r of it specular, r diffuse
//   reflected from below       D = (1 − m)(1 − F0)(1 − t) Y, diffuse
//   transmitted                T = (1 − m)(1 − F0) t Y
//   absorbed                   the rest
// With alphaMode BLEND the alpha of the base colour is the covered fraction, the rest is open; with
// MASK an alpha below the cutoff leaves the whole surface open. KHR_materials_pbrSpecularGlossiness
// replaces R by the luminance of its specular colour, D by that of its diffuse colour times 1 − R,
// and r by 1 − glossiness. Textures and emission are ignored.
// A dielectric (m = 0) with KHR_materials_ior, n from 1 to 10, that covers the whole surface
// depends on the angle instead, by raytrace/surfaces/glass.h. It is glass of index n and roughness
// r over ground that scatters the fraction Y of the entering light (t = 0), or a pane with the
// transmittance Y (t = 1, r = 0). This is only a rough substitute for measured values: colours for
// drawing hardly determine absorptance.
OpticalSurface derived_surface(const nlohmann::json& material, int bands, std::string name);

// Derived surface with the base colour multiplied by a picture's mean, linear red, green and blue.
OpticalSurface derived_surface(nlohmann::json material, const std::array<double, 3>& picture,
                               int bands, std::string name);

// KHR_texture_transform of the base colour's texture: texture coordinates on the picture are
// scaled, then rotated, then displaced. Empty for a material without it. Exporters that pack
// texture coordinates into integers use it. Throws InputError for invalid numbers.
using UvTransform = Eigen::Affine2d;
std::optional<UvTransform> uv_transform(const Document& document, int material);

// Whether a texture, which derived_surface() ignores, would change its result.
bool has_ignored_texture(const nlohmann::json& material);

// Converts JSON to the tree of core/settings. Throws InputError for null, which settings do not
// support.
SettingsNode settings_from_json(const nlohmann::json& value, const InputLocation& where);

// Fractions of the first band, such as "absorptance 0.83, specular 0.01, diffuse 0.16,
// transmittance 0"; then a short description of the BSDF.
std::string describe_surface(const OpticalSurface& surface);

}  // namespace photorque::gltf
