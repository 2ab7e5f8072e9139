// Data of TraceableScene; for the files of raytrace only.
#pragma once

#include <vector>

#include "raytrace/surfaces/bsdf.h"
#include "raytrace/tracing/embree_seam.h"
#include "raytrace/tracing/tracer.h"

namespace photorque {

// The plane of a triangle: points p, relative to the scene's centre_m in body axes, with
// normal · p = offset_m. The normal has unit length and points to the front.
struct TrianglePlane {
  Vec3 normal;
  double offset_m;
};
static_assert(sizeof(TrianglePlane) == 4 * sizeof(double), "planes are loaded as four numbers");

struct TraceableScene::Data {
  Data() = default;
  ~Data();
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  Scene scene;
  RTCDevice device = nullptr;
  RTCScene embree = nullptr;
  int packet_width = 8;  // rays per packet that Embree executes natively on this machine
  std::vector<uint32_t> first_triangle;  // per instance: index into `planes`
  std::vector<TrianglePlane> planes;
  std::vector<uint8_t> flat;  // 1: all triangles of the instance have the identical plane
  // Properties that are often needed at hits, indexed by side().
  std::array<std::vector<double>, max_bands> absorbed_fraction;
  std::vector<uint8_t> black;  // 1: the side absorbs all light and does not re-emit
  // Null if the fractions are equal at every angle; the vector is empty if all are null.
  std::vector<const AlbedoLaw*> albedo_law;
  bool reemits = false;  // whether any surface emits heat radiation
  // Sphere that contains the scene. Embree's vertices and rays are relative to its centre, so that
  // a distant scene keeps its precision.
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0.0;
  // Ray offset: distance from the surface at which a ray starts. It is larger than the
  // single-precision rounding of any point of the scene and smaller than any feature.
  double ray_offset_m = 0.0;

  // Ray offset behind a face of an instance, for light that has passed through it.
  double behind_m(uint32_t instance) const {
    return ray_offset_m + scene.instances[instance].sheet_depth_m;
  }
  // Index of an instance's back (`front` = 0) or front (1).
  static size_t side(uint32_t instance, uint8_t front) { return 2 * instance + front; }
  const OpticalSurface& surface(uint32_t instance, uint8_t front) const {
    return scene.surface(scene.instances[instance], front != 0);
  }
  const TrianglePlane& plane(uint32_t instance, uint32_t triangle) const {
    return planes[first_triangle[instance] + triangle];
  }
  // Normal on the front or the back of a triangle.
  Vec3 normal(uint32_t instance, uint32_t triangle, uint8_t front) const {
    const Vec3& outward = plane(instance, triangle).normal;
    return front != 0 ? outward : Vec3(-outward);
  }
};

}  // namespace photorque
