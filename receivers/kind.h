// How a `[[receiver]]` of an experiment becomes a Receiver.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"

namespace photorque {

// One kind of receiver: `kind = "flux_map"`.
struct ReceiverKind {
  std::string name;
  std::string summary;  // one sentence, no full stop
  // Reads every key it knows; throws InputError, also when the scene lacks the named node.
  std::function<std::unique_ptr<Receiver>(const Settings&, const Scene&)> make;
};

// Every kind named in receivers/CMakeLists.txt, in that order.
std::vector<ReceiverKind> all_receiver_kinds();

}  // namespace photorque
