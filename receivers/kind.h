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

// A receiver, with typed pointers for parts of the program that need more than the interface
// Receiver: gathering and photovoltaics use flux maps, gathering uses torque maps, tables of
// wrenches use wrenches. Null for other kinds.
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
  // Reads all keys of the kind. Throws InputError for invalid keys or if the scene lacks the named
  // node.
  std::function<MadeReceiver(const Settings&, const Scene&)> make;
  // Keys that `make` reads, in addition to `kind`.
  std::vector<Key> keys = {};
};

// Every kind named in receivers/CMakeLists.txt, in that order.
std::vector<ReceiverKind> all_receiver_kinds();

// Target of a receiver, and the name of its results.
struct ReceiverTarget {
  std::string name;
  std::vector<uint32_t> instances;  // of the scene
};

// Name of the results of a receiver called `name`: valid on every file system, at most 150 letters.
// Tables may refer to a receiver by either name.
std::string receiver_name(std::string name);

// Reads `node` and `name`. Throws InputError if the scene has no such node (with the most similar
// names) or if the node contains no mesh.
ReceiverTarget read_target(const Settings& settings, const Scene& scene);
// Reads a target. Without `node` it is the whole scene with the name `otherwise_name`.
ReceiverTarget read_target_or_all(const Settings& settings, const Scene& scene,
                                  const std::string& otherwise_name);

// Makes the grid from the keys of surface_grid_keys().
SurfaceGrid read_surface_grid(const Settings& settings, const Scene& scene,
                              const ReceiverTarget& target, Side default_side);

// Keys of read_target(), of read_target_or_all() with that name, and of read_surface_grid().
std::vector<Key> target_keys();
std::vector<Key> target_or_all_keys(const std::string& otherwise_name);
std::vector<Key> surface_grid_keys(Side default_side);

// Reference point of torques.
inline constexpr Vec3Key torque_point("about_m", {0.0, 0.0, 0.0},
                                      "reference point of the torques, body axes");

}  // namespace photorque
