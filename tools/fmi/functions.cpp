// The functions of FMI 3.0. A co-simulation unit must export all of them.
#include <string>

#include "tools/fmi/instance.h"

// NOLINTBEGIN(readability-identifier-naming)

using namespace photorque;
using namespace photorque::fmi;

PHOTORQUE_EXPORT const char* fmi3GetVersion() {
  return "3.0";
}

PHOTORQUE_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean on, size_t count,
                                                const fmi3String categories[]) {
  return guarded(handle, __func__, &Instance::set_debug_logging, on, count, categories);
}

PHOTORQUE_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean, fmi3Boolean logging,
    fmi3Boolean event_mode_used, fmi3Boolean, const fmi3ValueReference*, size_t intermediate,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback) {
  LogSink sink;
  if (log != nullptr) {
    sink = [environment, log](fmi3Status status, const char* category, const char* message) {
      log(environment, status, category, message);
    };
  }
  if (event_mode_used || intermediate > 0) {
    if (sink) {
      sink(fmi3Error, "logStatusError",
           "fmi3InstantiateCoSimulation: the unit has neither an event mode nor intermediate "
           "updates");
    }
    return nullptr;
  }
  return instantiate("fmi3InstantiateCoSimulation", name, token, resource_path, logging, sink);
}

PHOTORQUE_EXPORT void fmi3FreeInstance(fmi3Instance handle) {
  delete static_cast<Instance*>(handle);
}

PHOTORQUE_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean,
                                                        fmi3Float64, fmi3Float64 start_s,
                                                        fmi3Boolean has_stop, fmi3Float64 stop_s) {
  return guarded(handle, __func__, [&](Instance& instance) {
    instance.set_up(start_s, has_stop ? std::optional<double>(stop_s) : std::nullopt);
    return instance.enter_initialization();
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance handle) {
  return guarded(handle, __func__, &Instance::exit_initialization);
}

PHOTORQUE_EXPORT fmi3Status fmi3Terminate(fmi3Instance handle) {
  return guarded(handle, __func__, &Instance::terminate);
}

PHOTORQUE_EXPORT fmi3Status fmi3Reset(fmi3Instance handle) {
  return guarded(handle, __func__, &Instance::reset);
}

PHOTORQUE_EXPORT fmi3Status fmi3DoStep(fmi3Instance handle, fmi3Float64 now_s, fmi3Float64 step_s,
                                       fmi3Boolean, fmi3Boolean* event, fmi3Boolean* terminate,
                                       fmi3Boolean* early, fmi3Float64* reached_s) {
  return guarded(handle, "fmi3DoStep", [&](Instance& instance) {
    *event = *early = *terminate = false;
    const fmi3Status status = instance.step(now_s, step_s);
    *terminate = instance.has_ended();
    *reached_s = instance.now_s();
    return status;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance handle, const fmi3ValueReference of[],
                                           size_t count, fmi3Float64 values[], size_t size) {
  return guarded(handle, "fmi3GetFloat64", [&](Instance& instance) {
    if (size != count) return instance.refuse("fmi3GetFloat64: every variable is one number");
    return instance.get_numbers({of, count}, values);
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance handle, const fmi3ValueReference of[],
                                           size_t count, const fmi3Float64 values[], size_t size) {
  return guarded(handle, "fmi3SetFloat64", [&](Instance& instance) {
    if (size != count) return instance.refuse("fmi3SetFloat64: every variable is one number");
    return instance.set_numbers({of, count}, values);
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3GetBoolean(fmi3Instance handle, const fmi3ValueReference of[],
                                           size_t count, fmi3Boolean values[], size_t size) {
  return guarded(handle, "fmi3GetBoolean", [&](Instance& instance) {
    if (size != count) return instance.refuse("fmi3GetBoolean: every variable is one value");
    return instance.get_flags({of, count}, values);
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState* to) {
  return guarded(handle, __func__, &Instance::save_state, to);
}

PHOTORQUE_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState from) {
  return guarded(handle, __func__, &Instance::restore_state, __func__, from);
}

PHOTORQUE_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState* state) {
  return guarded(handle, __func__, &Instance::free_state, state);
}

PHOTORQUE_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState from,
                                                       size_t* size) {
  return guarded(handle, __func__, &Instance::find_state_size, from, size);
}

PHOTORQUE_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState from,
                                                  fmi3Byte bytes[], size_t size) {
  return guarded(handle, __func__, &Instance::write_state, from, bytes, size);
}

PHOTORQUE_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte bytes[],
                                                    size_t size, fmi3FMUState* to) {
  return guarded(handle, __func__, &Instance::read_state, bytes, size, to);
}

// Functions that the unit does not support.
PHOTORQUE_ABSENT(fmi3GetFloat32)
PHOTORQUE_ABSENT(fmi3GetInt8)
PHOTORQUE_ABSENT(fmi3GetUInt8)
PHOTORQUE_ABSENT(fmi3GetInt16)
PHOTORQUE_ABSENT(fmi3GetUInt16)
PHOTORQUE_ABSENT(fmi3GetInt32)
PHOTORQUE_ABSENT(fmi3GetUInt32)
PHOTORQUE_ABSENT(fmi3GetInt64)
PHOTORQUE_ABSENT(fmi3GetUInt64)
PHOTORQUE_ABSENT(fmi3GetString)
PHOTORQUE_ABSENT(fmi3GetBinary)
PHOTORQUE_ABSENT(fmi3GetClock)
PHOTORQUE_ABSENT(fmi3SetFloat32)
PHOTORQUE_ABSENT(fmi3SetInt8)
PHOTORQUE_ABSENT(fmi3SetUInt8)
PHOTORQUE_ABSENT(fmi3SetInt16)
PHOTORQUE_ABSENT(fmi3SetUInt16)
PHOTORQUE_ABSENT(fmi3SetInt32)
PHOTORQUE_ABSENT(fmi3SetUInt32)
PHOTORQUE_ABSENT(fmi3SetInt64)
PHOTORQUE_ABSENT(fmi3SetUInt64)
PHOTORQUE_ABSENT(fmi3SetBoolean)
PHOTORQUE_ABSENT(fmi3SetString)
PHOTORQUE_ABSENT(fmi3SetBinary)
PHOTORQUE_ABSENT(fmi3SetClock)
PHOTORQUE_ABSENT(fmi3GetNumberOfVariableDependencies)
PHOTORQUE_ABSENT(fmi3GetVariableDependencies)
PHOTORQUE_ABSENT(fmi3GetDirectionalDerivative)
PHOTORQUE_ABSENT(fmi3GetAdjointDerivative)
PHOTORQUE_ABSENT(fmi3EnterConfigurationMode)
PHOTORQUE_ABSENT(fmi3ExitConfigurationMode)
PHOTORQUE_ABSENT(fmi3GetIntervalDecimal)
PHOTORQUE_ABSENT(fmi3GetIntervalFraction)
PHOTORQUE_ABSENT(fmi3GetShiftDecimal)
PHOTORQUE_ABSENT(fmi3GetShiftFraction)
PHOTORQUE_ABSENT(fmi3SetIntervalDecimal)
PHOTORQUE_ABSENT(fmi3SetIntervalFraction)
PHOTORQUE_ABSENT(fmi3SetShiftDecimal)
PHOTORQUE_ABSENT(fmi3SetShiftFraction)
PHOTORQUE_ABSENT(fmi3EvaluateDiscreteStates)
PHOTORQUE_ABSENT(fmi3UpdateDiscreteStates)
PHOTORQUE_ABSENT(fmi3EnterEventMode)
PHOTORQUE_ABSENT(fmi3EnterStepMode)
PHOTORQUE_ABSENT(fmi3GetOutputDerivatives)
PHOTORQUE_ABSENT(fmi3ActivateModelPartition)
// Functions of model exchange, which the unit does not support.
PHOTORQUE_ABSENT(fmi3EnterContinuousTimeMode)
PHOTORQUE_ABSENT(fmi3CompletedIntegratorStep)
PHOTORQUE_ABSENT(fmi3SetTime)
PHOTORQUE_ABSENT(fmi3SetContinuousStates)
PHOTORQUE_ABSENT(fmi3GetContinuousStates)
PHOTORQUE_ABSENT(fmi3GetContinuousStateDerivatives)
PHOTORQUE_ABSENT(fmi3GetNominalsOfContinuousStates)
PHOTORQUE_ABSENT(fmi3GetEventIndicators)
PHOTORQUE_ABSENT(fmi3GetNumberOfContinuousStates)
PHOTORQUE_ABSENT(fmi3GetNumberOfEventIndicators)

namespace {

fmi3Instance refuse_interface(const char* function, fmi3InstanceEnvironment environment,
                              fmi3LogMessageCallback log) {
  const std::string message = std::string(function) + ": the unit is for co-simulation alone";
  if (log != nullptr) log(environment, fmi3Error, "logStatusError", message.c_str());
  return nullptr;
}

}  // namespace

PHOTORQUE_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String,
                                                           fmi3Boolean, fmi3Boolean,
                                                           fmi3InstanceEnvironment environment,
                                                           fmi3LogMessageCallback log) {
  return refuse_interface("fmi3InstantiateModelExchange", environment, log);
}

PHOTORQUE_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback,
    fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback) {
  return refuse_interface("fmi3InstantiateScheduledExecution", environment, log);
}
// NOLINTEND(readability-identifier-naming)
