// Optical properties of the materials of a glTF document.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "core/settings/settings.h"
#include "scenes/gltf/file/document.h"
#include "scenes/gltf/reader.h"
#include "scenes/surfaces/settings.h"

namespace photorque::gltf {

struct MaterialOptics {
  SheetOptics sheet;
  OpticsOrigin origin = OpticsOrigin::derived;
};

// Materials of an experiment, by name.
using MaterialOverrides = std::map<std::string, SheetOptics>;

// Reads the experiment's [[material]] tables, all of them, whether their material is in use or not.
// Throws InputError as read_sheet() does, for a name twice, and for a name that no material of the
// document has (with the most similar one).
MaterialOverrides read_overrides(const Document& document, const GltfOptions& options,
                                 const SurfaceFiles& files);

// The optics of material `index` (−1: of primitives without one, the specification's default), from
// the first of:
//   1. an override of the same name;
//   2. the material's extras: {"photorque": {"absorptance": 0.9, …}}, keys as in read_sheet();
//   3. the values meant for drawing, by the rule of derived_surface().
// Throws InputError as read_sheet() does, and for keys in extras.photorque that are unknown.
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
// A dielectric (m = 0) that carries KHR_materials_ior, n from 1 to 10, and covers everything
// depends on the angle instead, by raytrace/surfaces/glass.h: glass of index n and roughness r over
// ground that scatters Y of what enters (t = 0), or a pane that passes Y on a way through (t = 1, r
// = 0). It replaces measured values only roughly: colours for drawing hardly determine absorptance.
OpticalSurface derived_surface(const nlohmann::json& material, int bands, std::string name);

// The derived surface with the base colour multiplied by a picture's mean, linear red, green and
// blue.
OpticalSurface derived_surface(nlohmann::json material, const std::array<double, 3>& picture,
                               int bands, std::string name);

// KHR_texture_transform of the base colour's texture: where on the picture texture coordinates lie,
// scaled, then turned, then moved. Nothing for a material without one. Exporters that pack texture
// coordinates into integers unpack them by it. Throws InputError for numbers that are none.
using UvTransform = Eigen::Affine2d;
std::optional<UvTransform> uv_transform(const Document& document, int material);

// Whether a texture would change the result of derived_surface() from the factors alone.
bool has_ignored_texture(const nlohmann::json& material);

// Converts JSON to the tree that core/settings reads. Throws InputError for null, which settings do
// not have.
SettingsNode settings_from_json(const nlohmann::json& value, const InputLocation& where);

// "absorptance 0.83, specular 0.01, diffuse 0.16, transmittance 0" of the first band; then the
// BSDF in a few words.
std::string describe_surface(const OpticalSurface& surface);

}  // namespace photorque::gltf
