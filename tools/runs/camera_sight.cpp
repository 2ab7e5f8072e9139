#include "tools/runs/camera_sight.h"

#include <algorithm>
#include <memory>

#include "raytrace/tracing/shadow.h"
#include "scenes/gltf/reader.h"

namespace photorque {
namespace {

// Where the markers' light starts, as a model of a small body has no thickness to stand on.
constexpr double least_height_m = 1e-4;

bool is_shaded(const TraceableScene& scene, const Marker& marker, const Vec3& camera_body_m) {
  const double height_m = std::max(least_height_m, shadow_ray_offset_m(scene));
  const Vec3 start_m = marker.position_body_m + height_m * marker.normal_body;
  const Vec3 way_m = camera_body_m - start_m;
  const double length_m = way_m.norm();
  ShadowRay ray{};
  for (int k = 0; k < 3; ++k) {
    ray.origin_m[k] = static_cast<float>(start_m[k]);
    ray.direction[k] = static_cast<float>(way_m[k] / length_m);
  }
  ray.length_m = static_cast<float>(length_m);
  uint8_t lit = 1;
  find_shadows(scene, {&ray, 1}, {&lit, 1});
  return lit == 0;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> look_through_scene(const ExperimentFile& file,
                                                                    Sensors& sensors) {
  if (!file.scene_file || !sensors.camera || !sensors.camera->geometry) return {};
  GltfModel model = read_gltf(*file.scene_file, {.bands = file.bands,
                                                 .metres_per_unit = file.metres_per_unit,
                                                 .origin_m = file.centre_of_rotation_m,
                                                 .may_leave_folder = file.may_leave_folder});
  const auto scene = std::make_shared<const TraceableScene>(std::move(model.scene));
  TrackingCamera& camera = *sensors.camera->geometry;
  camera.is_hidden = [scene, markers = camera.markers,
                      camera_m = camera.lab_from_camera.translation_m](size_t marker,
                                                                       const Quat& lab_from_body) {
    return is_shaded(*scene, markers[marker], lab_from_body.conjugate() * camera_m);
  };
  return model.inputs;
}

}  // namespace photorque
