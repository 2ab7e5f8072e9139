// The geometry and surfaces of a platform: plain structs linked by index.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/spectrum.h"
#include "core/transform.h"
#include "raytrace/surfaces/bsdf.h"

namespace photorque {

// Triangles in the mesh frame, counter-clockwise seen from the front.
struct Mesh {
  std::vector<Vec3> vertices_m;
  std::vector<std::array<uint32_t, 3>> triangles;  // indices into vertices_m
  std::vector<Vec2> uv;                            // texture coordinates, per vertex, or empty
  bool encloses = false;  // has an inside: closed except perhaps for a few edges (see MeshClosure)
};

// A mesh placed in the body frame, with a surface on each side.
struct Instance {
  std::string node;      // name of the node that holds it
  std::string path;      // names from the root down to the node, joined by "/"
  std::string material;  // name of its material, possibly empty
  uint32_t mesh = 0;
  uint32_t front_surface = 0;
  uint32_t back_surface = 0;
  // May mirror (negative determinant). The tracer then reverses the winding, so that the front
  // stays the front.
  Affine body_from_mesh = Affine::Identity();
  // Thickness [m] of the sheet below a face of this part. Faces within this distance belong to the
  // same sheet: light that passes through the face passes them too. See scenes/gltf/coincident.h.
  double sheet_depth_m = 0.0;
};

// Everything is in the body frame: metres, origin at the centre of rotation, z up at zero tilt.
struct Scene {
  std::vector<Mesh> meshes;
  std::vector<OpticalSurface> surfaces;
  std::vector<Instance> instances;
  Bands bands;

  // The surface on one side of an instance.
  const OpticalSurface& surface(const Instance& instance, bool front) const {
    return surfaces[front ? instance.front_surface : instance.back_surface];
  }
  // Whether either side of an instance transmits light.
  bool transmits(const Instance& instance) const {
    return any_positive(surface(instance, true).transmitted) ||
           any_positive(surface(instance, false).transmitted);
  }
  // Box along the body axes around one part or all parts; empty if there are no vertices.
  Eigen::AlignedBox3d box_of(const Instance& instance) const;
  Eigen::AlignedBox3d box() const;
  // Largest distance of any vertex from the body origin [m]; 0 for an empty scene.
  double radius_m() const;
  // Indices of the instances of the node `name` (its name, its path or the end of its path) and of
  // all nodes below it; empty if there is none.
  std::vector<uint32_t> instances_of(const std::string& name) const;
};

}  // namespace photorque
