// The functions of FMI 2.0. A co-simulation unit must export all of them. Types, values and order
// of the arguments are those of the specification (Functional Mock-up Interface for Model Exchange
// and Co-Simulation 2.0.4, sections 2.1 and 4.2).
#include <cstdarg>
#include <string>

#include "core/text/parse.h"
#include "tools/fmi/instance.h"

// NOLINTBEGIN(readability-identifier-naming,cert-dcl50-cpp)

using namespace photorque;
using namespace photorque::fmi;

using fmi2Component = void*;
using fmi2FMUstate = void*;
using fmi2ValueReference = unsigned int;
using fmi2Real = double;
using fmi2Boolean = int;
using fmi2String = const char*;
using fmi2Byte = char;
// Its first five values are those of FMI 2.0; fmi2Pending is not used.
using fmi2Status = fmi3Status;
enum fmi2Type { fmi2ModelExchange, fmi2CoSimulation };
enum fmi2StatusKind { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated };

struct fmi2CallbackFunctions {
  void (*logger)(void* environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String message, ...);
  void* (*allocateMemory)(size_t, size_t);
  void (*freeMemory)(void*);
  void (*stepFinished)(void* environment, fmi2Status status);
  void* componentEnvironment;
};

namespace {

// Path "/a b" from "file:///a%20b", "file:/a b" or "file://localhost/a b". Null for another kind of
// address.
std::optional<std::string> path_of(std::string_view location) {
  constexpr std::string_view scheme = "file:", host = "//localhost/", no_host = "///";
  if (!location.starts_with(scheme)) return std::string(location);
  location.remove_prefix(scheme.size());
  if (location.starts_with(host)) {
    location.remove_prefix(host.size() - 1);
  } else if (location.starts_with(no_host)) {
    location.remove_prefix(no_host.size() - 1);
  }
  return percent_decoded(location);
}

// Escapes a message for the logger, which expects a printf format.
std::string as_format(const char* message) {
  std::string format;
  for (const char* c = message; *c != '\0'; ++c) {
    format += *c;
    if (*c == '%') format += '%';
  }
  return format;
}

}  // namespace

PHOTORQUE_EXPORT const char* fmi2GetTypesPlatform() {
  return "default";
}

PHOTORQUE_EXPORT const char* fmi2GetVersion() {
  return "2.0";
}

PHOTORQUE_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                               fmi2String resource_location,
                                               const fmi2CallbackFunctions* callbacks, fmi2Boolean,
                                               fmi2Boolean logging) {
  LogSink sink;
  if (callbacks != nullptr && callbacks->logger != nullptr) {
    sink = [call = *callbacks, instance = std::string(name != nullptr ? name : "")](
               fmi3Status status, const char* category, const char* message) {
      call.logger(call.componentEnvironment, instance.c_str(), status, category,
                  as_format(message).c_str());
    };
  }
  if (type != fmi2CoSimulation) {
    if (sink) {
      sink(fmi3Error, "logStatusError", "fmi2Instantiate: the unit is for co-simulation alone");
    }
    return nullptr;
  }
  const std::optional<std::string> folder =
      resource_location != nullptr ? path_of(resource_location) : std::nullopt;
  return instantiate("fmi2Instantiate", name, guid, folder ? folder->c_str() : nullptr,
                     logging != 0, sink);
}

PHOTORQUE_EXPORT void fmi2FreeInstance(fmi2Component handle) {
  delete static_cast<Instance*>(handle);
}

PHOTORQUE_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component handle, fmi2Boolean on, size_t count,
                                                const fmi2String categories[]) {
  return guarded(handle, __func__, &Instance::set_debug_logging, on != 0, count, categories);
}

PHOTORQUE_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component handle, fmi2Boolean, fmi2Real,
                                                fmi2Real start_s, fmi2Boolean has_stop,
                                                fmi2Real stop_s) {
  return guarded(handle, __func__, &Instance::set_up, start_s,
                 has_stop != 0 ? std::optional<double>(stop_s) : std::nullopt);
}

PHOTORQUE_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component handle) {
  return guarded(handle, __func__, &Instance::enter_initialization);
}

PHOTORQUE_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component handle) {
  return guarded(handle, __func__, &Instance::exit_initialization);
}

PHOTORQUE_EXPORT fmi2Status fmi2Terminate(fmi2Component handle) {
  return guarded(handle, __func__, &Instance::terminate);
}

PHOTORQUE_EXPORT fmi2Status fmi2Reset(fmi2Component handle) {
  return guarded(handle, __func__, &Instance::reset);
}

// If the platform reaches its stop, the step ends early: the result is fmi2Discard, and
// fmi2Terminated is true.
PHOTORQUE_EXPORT fmi2Status fmi2DoStep(fmi2Component handle, fmi2Real now_s, fmi2Real step_s,
                                       fmi2Boolean) {
  return guarded(handle, "fmi2DoStep", [&](Instance& instance) {
    const fmi3Status status = instance.step(now_s, step_s);
    return status == fmi3OK && instance.has_ended() ? fmi3Discard : status;
  });
}

PHOTORQUE_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component handle, fmi2StatusKind kind,
                                                 fmi2Boolean* value) {
  return guarded(handle, "fmi2GetBooleanStatus", [&](Instance& instance) {
    if (kind != fmi2Terminated) return instance.refuse("only fmi2Terminated is a Boolean");
    *value = instance.has_ended() ? 1 : 0;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component handle, fmi2StatusKind kind,
                                              fmi2Real* value) {
  return guarded(handle, "fmi2GetRealStatus", [&](Instance& instance) {
    if (kind != fmi2LastSuccessfulTime) {
      return instance.refuse("only fmi2LastSuccessfulTime is a Real");
    }
    *value = instance.now_s();
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi2Status fmi2GetReal(fmi2Component handle, const fmi2ValueReference of[],
                                        size_t count, fmi2Real values[]) {
  return guarded(handle, __func__, &Instance::get_numbers, std::span(of, count), values);
}

PHOTORQUE_EXPORT fmi2Status fmi2SetReal(fmi2Component handle, const fmi2ValueReference of[],
                                        size_t count, const fmi2Real values[]) {
  return guarded(handle, __func__, &Instance::set_numbers, std::span(of, count), values);
}

PHOTORQUE_EXPORT fmi2Status fmi2GetBoolean(fmi2Component handle, const fmi2ValueReference of[],
                                           size_t count, fmi2Boolean values[]) {
  return guarded(handle, __func__, &Instance::get_flags<fmi2Boolean>, std::span(of, count), values);
}

PHOTORQUE_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component handle, fmi2FMUstate* to) {
  return guarded(handle, __func__, &Instance::save_state, to);
}

PHOTORQUE_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component handle, fmi2FMUstate from) {
  return guarded(handle, __func__, &Instance::restore_state, __func__, from);
}

PHOTORQUE_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component handle, fmi2FMUstate* state) {
  return guarded(handle, __func__, &Instance::free_state, state);
}

PHOTORQUE_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component handle, fmi2FMUstate from,
                                                       size_t* size) {
  return guarded(handle, __func__, &Instance::find_state_size, from, size);
}

PHOTORQUE_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component handle, fmi2FMUstate from,
                                                  fmi2Byte bytes[], size_t size) {
  return guarded(handle, __func__, &Instance::write_state, from, bytes, size);
}

PHOTORQUE_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component handle, const fmi2Byte bytes[],
                                                    size_t size, fmi2FMUstate* to) {
  return guarded(handle, __func__, &Instance::read_state, bytes, size, to);
}

// Functions that the unit does not support.
PHOTORQUE_ABSENT(fmi2GetInteger)
PHOTORQUE_ABSENT(fmi2GetString)
PHOTORQUE_ABSENT(fmi2SetInteger)
PHOTORQUE_ABSENT(fmi2SetBoolean)
PHOTORQUE_ABSENT(fmi2SetString)
PHOTORQUE_ABSENT(fmi2GetDirectionalDerivative)
PHOTORQUE_ABSENT(fmi2SetRealInputDerivatives)
PHOTORQUE_ABSENT(fmi2GetRealOutputDerivatives)
PHOTORQUE_ABSENT(fmi2CancelStep)
PHOTORQUE_ABSENT(fmi2GetStatus)
PHOTORQUE_ABSENT(fmi2GetIntegerStatus)
PHOTORQUE_ABSENT(fmi2GetStringStatus)
// Functions of model exchange, which the unit does not support.
PHOTORQUE_ABSENT(fmi2EnterEventMode)
PHOTORQUE_ABSENT(fmi2NewDiscreteStates)
PHOTORQUE_ABSENT(fmi2EnterContinuousTimeMode)
PHOTORQUE_ABSENT(fmi2CompletedIntegratorStep)
PHOTORQUE_ABSENT(fmi2SetTime)
PHOTORQUE_ABSENT(fmi2SetContinuousStates)
PHOTORQUE_ABSENT(fmi2GetDerivatives)
PHOTORQUE_ABSENT(fmi2GetEventIndicators)
PHOTORQUE_ABSENT(fmi2GetContinuousStates)
PHOTORQUE_ABSENT(fmi2GetNominalsOfContinuousStates)
// NOLINTEND(readability-identifier-naming,cert-dcl50-cpp)
