// What stands behind TraceableScene; for the files of raytrace only.
#pragma once

#include <vector>

#include "raytrace/tracing/embree_seam.h"
#include "raytrace/tracing/tracer.h"

namespace photorque {

// The plane of a triangle in the body frame: points p with normal · p = offset_m. The normal is of
// unit length on the front side.
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
  // absorbed_fraction[band][2 · instance + (1 if hit from the front)]
  std::array<std::vector<double>, max_bands> absorbed_fraction;
  // Whether a side absorbs everything and does nothing else, numbered alike.
  std::vector<uint8_t> black;
  // BSDF[2 · instance + (1 if hit from the front)], null for plain surfaces; empty if all are.
  std::vector<const Bsdf*> bsdf;
  Vec3 centre_m = Vec3::Zero();  // of a sphere that holds the scene
  double radius_m = 0.0;
  // How far a ray that leaves a surface starts above it: beyond single-precision rounding of any
  // point of the scene, below any feature.
  double ray_offset_m = 0.0;

  const TrianglePlane& plane(uint32_t instance, uint32_t triangle) const {
    return planes[first_triangle[instance] + triangle];
  }
};

}  // namespace photorque
