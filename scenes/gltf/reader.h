// glTF 2.0 files (.gltf and .glb) as scenes.
//
// Read: the default scene's node hierarchy with any invertible transforms, meshes of
// triangles, strips and fans, sparse accessors, texture coordinates 0, EXT_mesh_gpu_instancing, and
// of materials what optics.h says. Ignored, with a notice where it could surprise:
// points and lines, textures and images (opened only for GltfOptions::picture), cameras, lights,
// animations (the rest pose counts). Refused because the geometry would be wrong without
// it: skins, morph targets with non-zero weights, and every required extension that is not known to
// leave geometry alone.
//
// Frames: glTF is metres with +Y up; its (x, y, z) becomes body (x, −z, y).
//
// Sides: every triangle acts on light from both sides, whatever `doubleSided` says (that flag is an
// optimisation for drawing solids). Both sides have the material's optics unless it gives a `back`.
// Front is the side from which the corners run counter-clockwise; a mirroring transform leaves the
// front the front, as glTF demands.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/settings/settings.h"
#include "core/spectrum.h"
#include "raytrace/scene.h"
#include "scenes/gltf/file/open.h"

namespace photorque {

// A picture that a model carries. This folder opens none: the reader of an experiment supplies the
// function.
struct BaseColours {
  int width = 0, height = 0;  // texels, at least 1
  std::vector<float> rgb;     // linear red, green and blue in [0, 1]; row by row from the top
};

// From the bytes of a PNG or JPEG, whose values are sRGB as glTF has it. Throws InputError for
// bytes that are no picture.
using PictureReader = std::function<BaseColours(const std::string& bytes)>;

struct GltfOptions {
  Bands bands = {};
  // [[material]] tables of an experiment: `name`, and keys as in read_sheet(). They win over the
  // model's own properties. InputError if no material has the name.
  std::vector<Settings> materials = {};
  // The bytes of a file that one of them names, or nothing. (The model's own properties name files
  // beside the model.)
  std::function<std::optional<std::string>(const std::string& name)> material_file = {};
  // With it the base colour of derived materials comes from their pictures, triangle by triangle.
  PictureReader picture = {};
  // Length of one unit of the file [m]; CAD exports often count millimetres: 1e-3.
  double metres_per_unit = 1.0;
  // The point of the model that becomes the origin of the body frame, in body axes.
  Vec3 origin_m = Vec3::Zero();
  // Links and paths out of the model's folder are followed.
  bool may_leave_folder = false;
  // Most memory that the files, and the data made of them, may take.
  uint64_t largest_bytes = 4ull << 30;
};

// Where a material's optics came from.
enum class OpticsOrigin { experiment, extras, derived };

// A material in use. Surfaces are indices into Scene::surfaces, equal when both sides are alike.
struct GltfMaterial {
  std::string name;  // empty: primitives without a material, or a material without a name
  uint32_t front_surface = 0;
  uint32_t back_surface = 0;
  OpticsOrigin origin = OpticsOrigin::derived;
};

// One Instance per node, primitive (and GPU instance). Primitives that several nodes or meshes use
// are one Mesh. Nodes without a name are called "node_7" after their index.
struct GltfModel {
  Scene scene;
  std::vector<GltfMaterial> materials;
  std::vector<std::string> notices;  // one line each, without the file's name
  std::vector<std::pair<std::string, std::string>> inputs;  // file name, content hash: Provenance
};

// Throws InputError (file, JSON pointer of the value, found, expected) when the file, or an
// external buffer, is missing, malformed in any way that could matter to geometry, or beyond the
// options' limits. Positions are those of the file, exactly; transforms are in double.
GltfModel read_gltf(const std::filesystem::path& path, const GltfOptions& options = {});

// Reads given bytes; `name` is how messages call them, and external buffers come from `open`.
GltfModel read_gltf_bytes(const std::string& bytes, const std::string& name, const GltfOpen& open,
                          const GltfOptions& options = {});

}  // namespace photorque
