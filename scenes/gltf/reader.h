// glTF 2.0 files (.gltf and .glb) as scenes.
//
// Supported: the default scene's node hierarchy with any invertible transforms, meshes of
// triangles, strips and fans, sparse accessors, texture coordinates 0, EXT_mesh_gpu_instancing, and
// the material properties in optics.h. Ignored, with a notice where results could differ from
// expectation: points and lines, textures and images (opened only for GltfOptions::picture),
// cameras, lights, animations (the rest pose is used). Rejected, because the geometry would be
// wrong: skins, morph targets with non-zero weights, and every required extension that may change
// geometry and is not supported.
//
// Frames: glTF is metres with +Y up; its (x, y, z) becomes body (x, −z, y).
//
// Sides: every triangle interacts with light on both sides, regardless of `doubleSided` (a flag for
// faster drawing of solids). Both sides have the material's optics unless it states a `back`. The
// front is the side from which the corners run counter-clockwise; a mirroring transform does not
// swap front and back, as glTF requires.
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

// A picture contained in a model. This folder does not decode pictures: the reader of an experiment
// supplies the function.
struct BaseColours {
  int width = 0, height = 0;  // texels, at least 1
  std::vector<float> rgb;     // linear red, green and blue in [0, 1]; row by row from the top
};

// Decodes a PNG or JPEG with sRGB values, as glTF requires. Throws InputError for other bytes.
using PictureReader = std::function<BaseColours(const std::string& bytes)>;

struct GltfOptions {
  Bands bands = {};
  // [[material]] tables of an experiment: `name`, and keys as in read_sheet(). They override the
  // model's own properties. Throws InputError if no material has the name.
  std::vector<Settings> materials = {};
  // Returns the bytes of a file named by `materials`, or nothing. (Files named in the model are in
  // the model's folder.)
  std::function<std::optional<std::string>(const std::string& name)> material_file = {};
  // If set, the base colour of derived materials comes from their pictures, per triangle.
  PictureReader picture = {};
  // Length of one unit of the file [m]; CAD exports often use millimetres: 1e-3.
  double metres_per_unit = 1.0;
  // The point of the model that becomes the origin of the body frame, in body axes.
  Vec3 origin_m = Vec3::Zero();
  // Whether links and paths that leave the model's folder are followed.
  bool may_leave_folder = false;
  // Maximum memory for the files and the data made from them.
  uint64_t largest_bytes = 4ull << 30;
};

// Origin of a material's optics.
enum class OpticsOrigin { experiment, extras, derived };

// A material in use. Surfaces are indices into Scene::surfaces, equal when both sides are alike.
struct GltfMaterial {
  std::string name;  // empty: primitives without a material, or a material without a name
  uint32_t front_surface = 0;
  uint32_t back_surface = 0;
  OpticsOrigin origin = OpticsOrigin::derived;
};

// One Instance per node, primitive (and GPU instance). Primitives that several nodes or meshes use
// share one Mesh. A node without a name gets a name from its index, such as "node_7".
struct GltfModel {
  Scene scene;
  std::vector<GltfMaterial> materials;
  std::vector<std::string> notices;  // one line each, without the file's name
  std::vector<std::pair<std::string, std::string>> inputs;  // file name, content hash: Provenance
};

// Opens the files in the folder of a model; see read_file_beside().
GltfOpen files_beside(const std::filesystem::path& folder, uint64_t largest_bytes,
                      bool may_leave_folder);

// Throws InputError (file, JSON pointer of the value, found, expected) if the file or an external
// buffer is missing, malformed in a way that could affect geometry, or beyond the options' limits.
// Positions are exactly those of the file; transforms are in double precision.
GltfModel read_gltf(const std::filesystem::path& path, const GltfOptions& options = {});

// Reads given bytes; messages call them `name`, and external buffers come from `open`.
GltfModel read_gltf_bytes(const std::string& bytes, const std::string& name, const GltfOpen& open,
                          const GltfOptions& options = {});

}  // namespace photorque
