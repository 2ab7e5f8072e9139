// An instance of the unit, as an importer holds it.
#pragma once

#include <exception>
#include <memory>
#include <string>

#include "tools/fmi/standard.h"
#include "tools/fmi/unit.h"

// Functions that an importer may call.
#define PHOTORQUE_EXPORT extern "C" __attribute__((visibility("default")))

namespace photorque::fmi {

enum class Mode { instantiated, initialization, step, terminated };

struct Instance {
  fmi3InstanceEnvironment environment = nullptr;
  fmi3LogMessageCallback log = nullptr;
  bool tells_events = false;
  Mode mode = Mode::instantiated;
  UnitDescription description;
  std::unique_ptr<CoSimulation> run;
  Vec3 command_body_N_m = Vec3::Zero();
  double now_s = 0.0, start_s = 0.0, stop_s = 0.0;

  void say(fmi3Status status, const char* category, const std::string& message) const {
    if (log != nullptr) log(environment, status, category, message.c_str());
  }
  fmi3Status refuse(const std::string& message) const {
    say(fmi3Error, "logStatusError", message);
    return fmi3Error;
  }
  void tell_words() {
    for (const std::string& line : run->take_words()) {
      if (tells_events && !line.empty()) say(fmi3OK, "logEvents", line);
    }
  }
};

// Exceptions may not leave the unit.
template <typename Body>
fmi3Status guarded(fmi3Instance handle, const char* function, Body body) {
  auto* instance = static_cast<Instance*>(handle);
  if (instance == nullptr) return fmi3Error;
  try {
    return body(*instance);
  } catch (const std::exception& error) {
    instance->mode = Mode::terminated;
    return instance->refuse(std::string(function) + ": " + error.what());
  }
}

// Restarts the run and follows `commands`.
inline fmi3Status begin(Instance& instance, std::vector<Vec3> commands) {
  instance.run->begin(instance.start_s, instance.stop_s, std::move(commands));
  instance.tell_words();
  return fmi3OK;
}

}  // namespace photorque::fmi
