#include <algorithm>
#include <cmath>
#include <span>

#include "core/errors.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {
namespace {

void check(const Scene& scene) {
  const auto index_error = [](const std::string& what, size_t found, size_t count) {
    return InputError({"scene"}, what, std::to_string(found), "less than " + std::to_string(count));
  };
  for (const Instance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size()) {
      throw index_error(instance.path + " mesh", instance.mesh, scene.meshes.size());
    }
    for (const uint32_t surface : {instance.front_surface, instance.back_surface}) {
      if (surface >= scene.surfaces.size()) {
        throw index_error(instance.path + " surface", surface, scene.surfaces.size());
      }
    }
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) {
      throw InputError({"scene"}, instance.path, "a mesh without triangles", "triangles");
    }
    for (const auto& triangle : mesh.triangles) {
      for (const uint32_t vertex : triangle) {
        if (vertex >= mesh.vertices_m.size()) {
          throw index_error(instance.path + " vertex", vertex, mesh.vertices_m.size());
        }
      }
    }
    for (const Vec3& vertex : mesh.vertices_m) {
      if (!(instance.body_from_mesh * vertex).allFinite()) {
        throw InputError({"scene"}, instance.path, "a vertex that is not finite", "finite numbers");
      }
    }
  }
}

bool is_black(const OpticalSurface& surface, int bands) {
  return surface.bsdf == nullptr &&
         std::all_of(surface.absorbed.begin(), surface.absorbed.begin() + bands,
                     [](double fraction) { return fraction == 1.0; });
}

// If the part is flat, gives all its triangles the plane of the largest one. Returns whether it is
// flat.
bool flatten(std::span<const Vec3> vertices_m, const Mesh& mesh, double scene_radius_m,
             std::span<TrianglePlane> planes) {
  const double rounding_m = 1e-12 * scene_radius_m;
  size_t largest = 0;
  double most_m2 = 0.0;
  for (size_t i = 0; i < planes.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const Vec3 edge = vertices_m[b] - vertices_m[a];
    const double area_m2 = edge.cross(vertices_m[c] - vertices_m[a]).norm();
    if (area_m2 > most_m2) {
      most_m2 = area_m2;
      largest = i;
    }
  }
  const TrianglePlane plane = planes[largest];
  for (size_t i = 0; i < planes.size(); ++i) {
    if (plane.normal.dot(planes[i].normal) < 0.0) return false;
    for (const uint32_t vertex : mesh.triangles[i]) {
      if (std::abs(plane.normal.dot(vertices_m[vertex]) - plane.offset_m) > rounding_m) {
        return false;
      }
    }
  }
  std::fill(planes.begin(), planes.end(), plane);
  return true;
}

// Adds one instance to Embree in single precision and its planes in double precision.
void add_instance(TraceableScene::Data& data, const Instance& instance) {
  const Mesh& mesh = data.scene.meshes[instance.mesh];
  const bool mirrored = instance.body_from_mesh.linear().determinant() < 0.0;

  RTCGeometry geometry = rtcNewGeometry(data.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices_m.size()));
  auto* indices = static_cast<uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(uint32_t), mesh.triangles.size()));
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw NumericalError("Embree has no memory for " + std::to_string(mesh.triangles.size()) +
                         " triangles");
  }
  std::vector<Vec3> placed(mesh.vertices_m.size());
  for (size_t i = 0; i < placed.size(); ++i) {
    placed[i] = instance.body_from_mesh * mesh.vertices_m[i] - data.centre_m;
    for (int k = 0; k < 3; ++k)
      vertices[3 * i + static_cast<size_t>(k)] = static_cast<float>(placed[i][k]);
  }
  data.first_triangle.push_back(static_cast<uint32_t>(data.planes.size()));
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    // Barycentric weights refer to vertices 1 and 2 of the mesh, so their order must not change: a
    // mirrored instance has its normal reversed instead.
    indices[3 * i] = a;
    indices[3 * i + 1] = b;
    indices[3 * i + 2] = c;
    const Vec3 cross = (placed[b] - placed[a]).cross(placed[c] - placed[a]);
    const double length = cross.norm();
    const Vec3 normal = length > 0.0 ? Vec3(cross / (mirrored ? -length : length)) : Vec3::UnitZ();
    data.planes.push_back({normal, normal.dot(placed[a])});
  }
  const bool flat = flatten(placed, mesh, data.radius_m,
                            std::span(data.planes).subspan(data.first_triangle.back()));
  data.flat.push_back(flat ? 1 : 0);
  rtcCommitGeometry(geometry);
  // Its id equals the instance's index: both count from 0.
  rtcAttachGeometry(data.embree, geometry);
  rtcReleaseGeometry(geometry);
  for (const bool front : {false, true}) {
    const OpticalSurface& surface = data.scene.surface(instance, front);
    data.black.push_back(is_black(surface, data.scene.bands.count()) ? 1 : 0);
    for (size_t b = 0; b < max_bands; ++b) {
      data.absorbed_fraction[b].push_back(surface.absorbed[b]);
    }
    data.albedo_law.push_back(surface.bsdf == nullptr ? nullptr : surface.bsdf->law.get());
  }
}

void note_bsdfs(TraceableScene::Data& data) {
  if (std::all_of(data.albedo_law.begin(), data.albedo_law.end(),
                  [](const AlbedoLaw* law) { return law == nullptr; })) {
    data.albedo_law.clear();
  }
  data.reemits = std::any_of(data.scene.surfaces.begin(), data.scene.surfaces.end(),
                             [](const OpticalSurface& surface) {
                               return surface.bsdf != nullptr && surface.bsdf->reemitted > 0.0;
                             });
}

void bound(TraceableScene::Data& data) {
  const Eigen::AlignedBox3d box = data.scene.box();
  if (box.isEmpty()) return;
  data.centre_m = box.center();
  data.radius_m = 0.5 * box.diagonal().norm();
  // Single precision rounds a coordinate x by up to 6e-8 |x|; rays are relative to the centre.
  data.ray_offset_m = 5e-7 * data.radius_m;
}

}  // namespace

TraceableScene::Data::~Data() {
  if (embree != nullptr) rtcReleaseScene(embree);
  if (device != nullptr) rtcReleaseDevice(device);
}

TraceableScene::TraceableScene(Scene scene, bool leak_safe) : data_(std::make_unique<Data>()) {
  check(scene);
  data_->scene = std::move(scene);
  data_->device = rtcNewDevice(nullptr);
  if (data_->device == nullptr)
    throw NumericalError("Embree did not start, probably because of too little memory");
  data_->packet_width =
      rtcGetDeviceProperty(data_->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0 ? 16 : 8;
  data_->embree = rtcNewScene(data_->device);
  rtcSetSceneFlags(data_->embree, leak_safe ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  rtcSetSceneBuildQuality(data_->embree, RTC_BUILD_QUALITY_MEDIUM);
  bound(*data_);
  for (const Instance& instance : data_->scene.instances) add_instance(*data_, instance);
  note_bsdfs(*data_);
  rtcCommitScene(data_->embree);
  if (rtcGetDeviceError(data_->device) != RTC_ERROR_NONE) {
    throw NumericalError("Embree could not build its hierarchy");
  }
}

TraceableScene::~TraceableScene() = default;
TraceableScene::TraceableScene(TraceableScene&&) noexcept = default;

const Scene& TraceableScene::scene() const {
  return data_->scene;
}

}  // namespace photorque
