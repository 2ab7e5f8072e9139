// The keys that receivers of every kind share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/settings/keys.h"
#include "core/settings/settings.h"
#include "raytrace/scene.h"
#include "receivers/surface_grid.h"

namespace photorque {

// What a receiver looks at, and how its results are called.
//   node  name of a node of the scene (or its path, or part of it); with the nodes below it
//   name  of the results; a file stem. Default: the node's name
struct ReceiverTarget {
  std::string name;
  std::vector<uint32_t> instances;  // of the scene
};

// Reads `node` and `name`. InputError with the nearest node names when the scene has no such node
// or the node holds no mesh.
ReceiverTarget read_target(const Settings& settings, const Scene& scene);
// The same, but without `node` the whole scene is meant, called `otherwise_name`.
ReceiverTarget read_target_or_all(const Settings& settings, const Scene& scene,
                                  const std::string& otherwise_name);

// Reads
//   bins    [along u, along v], 1 … 4096 each; default [100, 100]
//   over    "plane" (default) or "uv": bins over a plane or over the texture coordinates
//   side    "front", "back" or "both": which side of the surface counts
//   facing  [x, y, z], optional: only faces turned towards this body direction, seen along it
// and lays the grid.
SurfaceGrid read_surface_grid(const Settings& settings, const Scene& scene,
                              const ReceiverTarget& target, Side default_side);

// The keys of read_target(), or of read_target_or_all() with that name; those of
// read_surface_grid(); and the point of torques.
std::vector<Key> target_keys();
std::vector<Key> target_or_all_keys(const std::string& otherwise_name);
std::vector<Key> surface_grid_keys(Side default_side);
Key torque_point_key();

}  // namespace photorque
