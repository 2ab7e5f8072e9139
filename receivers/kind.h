// Conversion of `[[receiver]]` of an experiment into a Receiver, and the common keys of all kinds.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/settings/typed_keys.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"
#include "receivers/surface_grid.h"

namespace photorque {

class FluxMapReceiver;    // receivers/flux_map.h
class TorqueMapReceiver;  // receivers/torque_map.h
class WrenchReceiver;     // receivers/wrench/wrench.h

// A receiver as its kind made it, with typed handles to those of which other parts of the program
// need more than a Receiver offers: gathering and photovoltaics for flux maps, gathering for torque
// maps, tables of wrenches for wrenches. Null for other kinds.
struct MadeReceiver {
  std::shared_ptr<const Receiver> receiver;
  std::shared_ptr<const FluxMapReceiver> flux_map = nullptr;
  std::shared_ptr<const WrenchReceiver> wrench = nullptr;
  std::shared_ptr<const TorqueMapReceiver> torque_map = nullptr;
};

// One kind of receiver: `kind = "flux_map"`.
struct ReceiverKind {
  std::string name;
  std::string summary;  // one sentence, no full stop
  // Reads all of its keys; throws InputError, also when the scene lacks the named node.
  std::function<MadeReceiver(const Settings&, const Scene&)> make;
  // The keys that `make` reads, beside `kind`.
  std::vector<Key> keys = {};
};

// Every kind named in receivers/CMakeLists.txt, in that order.
std::vector<ReceiverKind> all_receiver_kinds();

// The target of a receiver, and the name of its results.
//   node  name of a node of the scene (or its path, or part of it); with the nodes below it
//   name  of the results; a file stem. Default: the node's name
struct ReceiverTarget {
  std::string name;
  std::vector<uint32_t> instances;  // of the scene
};

// The name of the results of a receiver called `name`: one that every file system takes, of at most
// 150 letters. Tables that name a receiver may write either.
std::string receiver_name(std::string name);

// Reads `node` and `name`. InputError with the nearest node names when the scene has no such node
// or the node holds no mesh.
ReceiverTarget read_target(const Settings& settings, const Scene& scene);
// Reads a target; without `node` it is the whole scene, called `otherwise_name`.
ReceiverTarget read_target_or_all(const Settings& settings, const Scene& scene,
                                  const std::string& otherwise_name);

// Reads
//   bins    [along u, along v], 1 … 4096 each; default [100, 100]
//   over    "plane" (default) or "uv": bins over a plane or over the texture coordinates
//   side    "front", "back" or "both": side of the surface that counts
//   facing  [x, y, z], optional: only faces turned towards this body direction, seen along it
// and lays the grid.
SurfaceGrid read_surface_grid(const Settings& settings, const Scene& scene,
                              const ReceiverTarget& target, Side default_side);

// The keys of read_target(), or of read_target_or_all() with that name; those of
// read_surface_grid().
std::vector<Key> target_keys();
std::vector<Key> target_or_all_keys(const std::string& otherwise_name);
std::vector<Key> surface_grid_keys(Side default_side);

// The point of torques.
inline constexpr Vec3Key torque_point("about_m", {0.0, 0.0, 0.0},
                                      "the point that torques are about, body axes");

}  // namespace photorque
