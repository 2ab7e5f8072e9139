// The data of TraceableScene; for the files of raytrace only.
#pragma once

#include <vector>

#include "raytrace/surfaces/bsdf.h"
#include "raytrace/tracing/embree_seam.h"
#include "raytrace/tracing/tracer.h"

namespace photorque {

// The plane of a triangle: points p from the scene's centre_m with normal · p = offset_m, in body
// axes. The normal is of unit length on the front side.
struct TrianglePlane {
  double normal[3];
  double offset_m;
};

struct TraceableScene::Data {
  Data() = default;
  ~Data();
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  Scene scene;
  RTCDevice device = nullptr;
  RTCScene embree = nullptr;
  int packet_width = 8;                  // rays per packet that this machine's Embree runs natively
  std::vector<uint32_t> first_triangle;  // per instance, into `planes`
  std::vector<TrianglePlane> planes;
  std::vector<uint8_t> flat;  // 1: all triangles of the instance have one plane, to all digits
  // Properties that hits need often, numbered by side().
  std::array<std::vector<double>, max_bands> absorbed_fraction;  // [band][side], at every angle
  std::vector<uint8_t> black;  // 1: the side absorbs everything and does nothing else
  // Null where fractions are the same at every angle; empty if they are so everywhere.
  std::vector<const AlbedoLaw*> albedo_law;
  bool reemits = false;  // whether heat radiation leaves any surface
  // Sphere that contains the scene. Embree's vertices and rays are relative to its centre, so that
  // a distant scene does not lose single precision.
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0.0;
  // Ray offset: distance from the surface at which a ray starts, beyond single-precision rounding
  // of any point of the scene, below any feature.
  double ray_offset_m = 0.0;

  // Ray offset behind a face of an instance for light that has passed through it.
  double behind_m(uint32_t instance) const {
    return ray_offset_m + scene.instances[instance].sheet_depth_m;
  }
  // The number of an instance's back (`front` = 0) or front (1).
  static size_t side(uint32_t instance, uint8_t front) { return 2 * instance + front; }
  const OpticalSurface& surface(uint32_t instance, uint8_t front) const {
    const Instance& part = scene.instances[instance];
    return scene.surfaces[front != 0 ? part.front_surface : part.back_surface];
  }
  const TrianglePlane& plane(uint32_t instance, uint32_t triangle) const {
    return planes[first_triangle[instance] + triangle];
  }
};

}  // namespace photorque
