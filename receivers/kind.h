// How a `[[receiver]]` of an experiment becomes a Receiver.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/settings/keys.h"
#include "core/settings/settings.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"

namespace photorque {

class FluxMapReceiver;    // receivers/maps/flux_map.h
class TorqueMapReceiver;  // receivers/maps/torque_map.h
class WrenchReceiver;     // receivers/wrench/wrench.h

// A receiver as its kind made it, with handles of its own type to those that other parts of the
// program ask for more than a Receiver tells: gathering and photovoltaics for flux maps, gathering
// for torque maps, tables of wrenches for wrenches. Null for other kinds.
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
  // Reads every key it knows; throws InputError, also when the scene lacks the named node.
  std::function<MadeReceiver(const Settings&, const Scene&)> make;
  // The keys that `make` reads, beside `kind`.
  std::vector<Key> keys = {};
};

// Every kind named in receivers/CMakeLists.txt, in that order.
std::vector<ReceiverKind> all_receiver_kinds();

}  // namespace photorque
