#include "scenes/gltf/reader.h"

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/constants.h"
#include "core/files.h"
#include "core/provenance.h"
#include "core/text/format.h"
#include "scenes/gltf/geometry.h"
#include "scenes/gltf/mesh_closure.h"
#include "scenes/gltf/nodes.h"
#include "scenes/gltf/optics.h"
#include "scenes/gltf/texture.h"
#include "scenes/gltf/validation.h"

namespace photorque {
namespace {

using gltf::Document;
using gltf::MemoryBudget;
using gltf::Placement;
using gltf::pointer;

// Larger than any platform and most spacecraft; a larger model causes a notice.
constexpr double surprising_radius_m = 100.0;

// Converts (x, y, z) with y up to (x, −z, y).
Affine body_from_world(double metres_per_unit) {
  Affine transform = Affine::Identity();
  transform.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  transform.linear() *= metres_per_unit;
  return transform;
}

std::string in_quotes(const std::string& name) {
  return name.empty() ? "material without a name" : "material '" + name + "'";
}

// Builds the scene from a document.
class Assembly {
 public:
  Assembly(const Document& document, const GltfOpen& open, const GltfOptions& options,
           MemoryBudget* budget)
      : document_(document),
        options_(options),
        budget_(budget),
        geometry_(document, budget),
        open_(open),
        beside_model_(recorded(open)),
        overrides_(gltf::read_overrides(document, options, recorded(options.material_file))) {
    model_.scene.bands = options.bands;
    model_.notices = document.notices;
  }

  GltfModel build() {
    for (const Placement& placement : gltf::place_meshes(document_, budget_)) {
      const auto& primitives =
          document_.model.meshes[static_cast<size_t>(placement.mesh)].primitives;
      for (size_t p = 0; p < primitives.size(); ++p) {
        const std::optional<uint32_t> mesh = mesh_of(placement.mesh, p, primitives[p].material);
        if (mesh) add_instance(placement, *mesh, primitives[p].material);
      }
    }
    const MeshClosure closure = closure_of(model_.scene);
    for (size_t i = 0; i < closure.encloses.size(); ++i) {
      model_.scene.meshes[i].encloses = closure.encloses[i] != 0;
    }
    add_notices(closure);
    if (options_.picture) apply_pictures();
    check_resolution();
    return std::move(model_);
  }

 private:
  // Mesh of a primitive, read at its first use; empty if it has no triangles. Primitives that use
  // equal accessors in the same way share one mesh.
  std::optional<uint32_t> mesh_of(int mesh, size_t index, int material) {
    const tinygltf::Primitive& primitive =
        document_.model.meshes[static_cast<size_t>(mesh)].primitives[index];
    const auto attribute = [&](const char* name) {
      const auto found = primitive.attributes.find(name);
      return found == primitive.attributes.end() ? -1 : found->second;
    };
    const std::optional<gltf::UvTransform> transform = gltf::uv_transform(document_, material);
    const auto key = std::tuple(attribute("POSITION"), attribute("TEXCOORD_0"), primitive.indices,
                                primitive.mode, transform ? material : -1);
    const auto known = meshes_.find(key);
    if (known != meshes_.end()) return known->second;
    const std::optional<uint32_t> read = read_mesh(mesh, index);
    if (read && transform) {
      for (Vec2& uv : model_.scene.meshes[*read].uv) uv = *transform * uv;
    }
    return meshes_[key] = read;
  }

  std::optional<uint32_t> read_mesh(int mesh, size_t index) {
    std::optional<gltf::PrimitiveMesh> read = geometry_.read(mesh, index);
    if (!read) {
      ++without_triangles_;
      return std::nullopt;
    }
    degenerate_ += read->degenerate;
    if (read->without_uv) {
      model_.notices.push_back(pointer("meshes", mesh, "primitives", index) +
                               ": texture coordinates that are not finite are ignored");
    }
    if (read->mesh.triangles.empty()) return std::nullopt;
    // Includes the corners of omitted triangles: a very distant corner makes its triangle a needle,
    // which would otherwise remain unnoticed.
    double square = read->degenerate_reach * read->degenerate_reach;
    for (const Vec3& vertex : read->mesh.vertices_m) {
      square = std::max(square, vertex.squaredNorm());
    }
    radii_.push_back(std::sqrt(square));
    if (read->is_single) note_tilts(read->mesh, mesh);
    model_.scene.meshes.push_back(std::move(read->mesh));
    return static_cast<uint32_t>(model_.scene.meshes.size() - 1);
  }

  // Corners far from the origin of their mesh are rounded, which turns small facets.
  void note_tilts(const Mesh& mesh, int index) {
    constexpr double noticeable_rad = 2e-4;
    double area = 0.0, squares = 0.0, farthest = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 &p = mesh.vertices_m[a], &q = mesh.vertices_m[b], &r = mesh.vertices_m[c];
      const double twice_area = (q - p).cross(r - p).norm();
      const double longest = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
      const double largest =
          std::max({p.cwiseAbs().maxCoeff(), q.cwiseAbs().maxCoeff(), r.cwiseAbs().maxCoeff()});
      const double rounding = 0x1p-25 * largest;  // rms of the last bit
      const double tilt_rad = std::min(1.0, rounding * longest / twice_area);
      area += twice_area;
      squares += twice_area * tilt_rad * tilt_rad;
      farthest = std::max(farthest, largest);
    }
    const double tilt_rad = std::sqrt(squares / area);
    if (!(tilt_rad > noticeable_rad)) return;
    add_notice(pointer("meshes", index) +
               printed(": corners up to %.2g from the mesh's origin have single precision, which "
                       "turns the facets by about %.2g mrad (rms): move the origin to the mesh and "
                       "place its node",
                       farthest, 1e3 * tilt_rad));
  }

  void add_instance(const Placement& placement, uint32_t mesh, int material) {
    Instance instance;
    instance.body_from_mesh = body_from_world(options_.metres_per_unit) * placement.world_from_mesh;
    instance.body_from_mesh.pretranslate(-options_.origin_m);
    const double reach_m = instance.body_from_mesh.linear().norm() * radii_[mesh] +
                           instance.body_from_mesh.translation().norm();
    if (!(reach_m <= largest_extent_m)) {
      throw document_.wrong(pointer("nodes", placement.node),
                            printed("a mesh up to %g m away", reach_m), "at most 1e9 m");
    }
    budget_->charge(1, sizeof(Instance) + placement.path.size(), pointer("nodes", placement.node));
    const GltfMaterial& optics = material_of(material);
    instance.node = placement.name;
    instance.path = placement.path;
    instance.material = optics.name;
    instance.mesh = mesh;
    instance.front_surface = optics.front_surface;
    instance.back_surface = optics.back_surface;
    model_.scene.instances.push_back(std::move(instance));
    material_indices_.push_back(material);
  }

  // Reports parts that are too small: rays are relative to the middle of the scene in single
  // precision, which rounds to 6e-8 of its size.
  void check_resolution() {
    constexpr double too_small = 1e-6;  // of the scene's size
    Eigen::AlignedBox3d all;
    double least_m = INFINITY;
    const Instance* smallest = nullptr;
    for (const Instance& instance : model_.scene.instances) {
      const Eigen::AlignedBox3d box = model_.scene.box_of(instance);
      all.extend(box);
      const double size_m = box.diagonal().norm();
      if (size_m >= least_m) continue;
      least_m = size_m;
      smallest = &instance;
    }
    if (smallest == nullptr || least_m >= too_small * all.diagonal().norm()) return;
    throw document_.wrong(
        "",
        "\"" + smallest->path + "\"" +
            printed(", %.3g m long in a scene of %.3g m", least_m, all.diagonal().norm()),
        "parts of at least 1e-6 of the scene, which rays resolve to 6e-8 (leave "
        "out what is far away)");
  }

  // Replaces every instance with a coloured picture by one instance per luminance step of the
  // picture.
  void apply_pictures() {
    std::vector<Instance> all;
    std::map<std::pair<uint32_t, int>, std::vector<Instance>> known;  // by mesh and material
    std::map<int, std::optional<BaseColours>> pictures;
    std::set<std::string> uncoloured, of_other_coordinates;
    for (size_t i = 0; i < model_.scene.instances.size(); ++i) {
      const Instance& whole = model_.scene.instances[i];
      const int material = material_indices_[i];
      const bool is_derived =
          model_.materials[materials_.at(material)].origin == OpticsOrigin::derived;
      const bool has_coordinates = !model_.scene.meshes[whole.mesh].uv.empty();
      if (!is_derived || !has_coordinates) {
        if (is_derived && has_picture(material)) uncoloured.insert(whole.material);
        all.push_back(whole);
        continue;
      }
      if (!pictures.contains(material)) {
        pictures[material] =
            gltf::base_colour_picture(document_, material, open_, options_.picture, budget_);
      }
      const std::optional<BaseColours>& picture = pictures[material];
      if (!picture && has_picture(material)) of_other_coordinates.insert(whole.material);
      const auto [parts, is_new] = known.try_emplace({whole.mesh, material});
      if (is_new && picture) parts->second = parts_of(whole, material, *picture);
      if (parts->second.empty()) all.push_back(whole);
      for (Instance part : parts->second) {
        part.node = whole.node;
        part.path = whole.path;
        part.body_from_mesh = whole.body_from_mesh;
        all.push_back(std::move(part));
      }
    }
    for (const std::string& name : uncoloured) {
      model_.notices.push_back("material '" + name +
                               "': its picture is ignored if a mesh has no texture coordinates");
    }
    for (const std::string& name : of_other_coordinates) {
      model_.notices.push_back(
          "material '" + name +
          "': its picture is ignored: it does not use the first texture coordinates (texCoord)");
    }
    model_.scene.instances = std::move(all);
  }

  bool has_picture(int material) const {
    if (material < 0) return false;
    const tinygltf::Material& one = document_.model.materials[static_cast<size_t>(material)];
    return one.pbrMetallicRoughness.baseColorTexture.index >= 0;
  }

  std::vector<Instance> parts_of(const Instance& whole, int material, const BaseColours& picture) {
    std::vector<Instance> parts;
    double darkest = 1.0, brightest = 0.0;
    for (gltf::TextureStep& step : gltf::texture_steps(model_.scene.meshes[whole.mesh], picture)) {
      Instance part = whole;
      part.front_surface = part.back_surface = add_surface(
          gltf::derived_surface(document_.json["materials"][static_cast<size_t>(material)],
                                step.colour, options_.bands.count(), whole.material));
      const double absorbed = model_.scene.surfaces.back().absorbed[0];
      darkest = std::min(darkest, absorbed);
      brightest = std::max(brightest, absorbed);
      part.mesh = static_cast<uint32_t>(model_.scene.meshes.size());
      model_.scene.meshes.push_back(std::move(step.mesh));
      parts.push_back(std::move(part));
    }
    add_notice(in_quotes(whole.material) +
               printed(": absorptance %.3g to %.3g from the picture of its base colour", darkest,
                       brightest));
    return parts;
  }

  const GltfMaterial& material_of(int index) {
    const auto known = materials_.find(index);
    if (known != materials_.end()) return model_.materials[known->second];
    materials_[index] = model_.materials.size();
    const gltf::MaterialOptics optics =
        gltf::material_optics(document_, index, options_.bands.count(), overrides_, beside_model_);
    GltfMaterial material;
    if (index >= 0) {
      material.name = document_.model.materials[static_cast<size_t>(index)].name;
    }
    for (const std::string& line : optics.sheet.notices) {
      add_notice(in_quotes(material.name) + ": " + line);
    }
    material.origin = optics.origin;
    material.front_surface = add_surface(optics.sheet.front);
    material.back_surface =
        optics.sheet.back ? add_surface(*optics.sheet.back) : material.front_surface;
    if (optics.origin == OpticsOrigin::derived) {
      add_notice(in_quotes(material.name) + ": optical properties derived from PBR values: " +
                 gltf::describe_surface(optics.sheet.front) +
                 (has_texture(index) && !options_.picture ? " (textures are ignored)" : ""));
    }
    model_.materials.push_back(std::move(material));
    return model_.materials.back();
  }

  // Wraps `open` so that the files it finds become inputs.
  SurfaceFiles recorded(const SurfaceFiles& open) {
    if (!open) return {};
    return [this, open](const std::string& name) {
      std::optional<std::string> bytes = open(name);
      if (bytes) {
        budget_->charge(bytes->size(), 1, "");
        model_.inputs.emplace_back(name, content_hash(*bytes));
      }
      return bytes;
    };
  }

  // Several materials may share name and values; their notice appears once.
  void add_notice(const std::string& line) {
    if (reported_.insert(line).second) model_.notices.push_back(line);
  }

  bool has_texture(int material) const {
    return material >= 0 &&
           gltf::has_ignored_texture(document_.json["materials"][static_cast<size_t>(material)]);
  }

  uint32_t add_surface(const OpticalSurface& surface) {
    model_.scene.surfaces.push_back(surface);
    return static_cast<uint32_t>(model_.scene.surfaces.size() - 1);
  }

  void add_notices(const MeshClosure& closure) {
    const auto count = [&](size_t number, const std::string& what) {
      if (number > 0) model_.notices.push_back(std::to_string(number) + " " + what);
    };
    count(degenerate_, "triangle(s) without area left out");
    count(without_triangles_, "primitive(s) without triangles (points, lines) left out");
    const double radius_m = model_.scene.radius_m();
    if (radius_m > surprising_radius_m) {
      model_.notices.push_back(
          printed("the scene reaches %.3g m from the body's origin; CAD exports often count "
                  "millimetres",
                  radius_m));
    }
    const std::string leaks = describe_closure(closure);
    if (!leaks.empty()) model_.notices.push_back(leaks);
    if (document_.json.contains("animations")) {
      model_.notices.emplace_back("animations are ignored: everything is in its rest pose");
    }
    if (!document_.json.contains("scene") && document_.model.scenes.size() > 1) {
      model_.notices.emplace_back("no default scene is named: the first one is taken");
    }
  }

  const Document& document_;
  const GltfOptions& options_;
  MemoryBudget* budget_;
  gltf::GeometryReader geometry_;
  GltfModel model_;  // must precede the members that read files into it
  const GltfOpen& open_;
  SurfaceFiles beside_model_;
  gltf::MaterialOverrides overrides_;
  std::map<std::tuple<int, int, int, int, int>, std::optional<uint32_t>> meshes_;
  std::vector<double> radii_;          // radius of each mesh about its own origin
  std::map<int, size_t> materials_;    // index in the file → index in model_.materials
  std::vector<int> material_indices_;  // per instance: index in the file
  std::set<std::string> reported_;
  size_t degenerate_ = 0;
  size_t without_triangles_ = 0;
};

}  // namespace

GltfOpen files_beside(const std::filesystem::path& folder, uint64_t largest_bytes,
                      bool may_leave_folder) {
  return [=](const std::string& relative_path) {
    return read_file_beside(folder, relative_path, largest_bytes, may_leave_folder);
  };
}

GltfModel read_gltf_bytes(const std::string& bytes, const std::string& name, const GltfOpen& open,
                          const GltfOptions& options) {
  MemoryBudget budget(name, options.largest_bytes);
  budget.charge(bytes.size(), 1, "");
  const Document document = gltf::read_document(bytes, name, open, &budget);
  gltf::validate_accessors(document);
  gltf::validate_primitives(document);
  gltf::validate_nodes(document);
  GltfModel model = Assembly(document, open, options, &budget).build();
  std::vector<std::pair<std::string, std::string>> inputs = {{name, content_hash(bytes)}};
  inputs.insert(inputs.end(), document.inputs.begin(), document.inputs.end());
  model.inputs.insert(model.inputs.begin(), inputs.begin(), inputs.end());
  return model;
}

GltfModel read_gltf(const std::filesystem::path& path, const GltfOptions& options) {
  const std::string bytes = read_file(path, options.largest_bytes);
  const GltfOpen open =
      files_beside(path.parent_path(), options.largest_bytes, options.may_leave_folder);
  GltfModel model = read_gltf_bytes(bytes, path.string(), open, options);
  model.inputs.front().first = path.filename().string();
  return model;
}

}  // namespace photorque
