// The functions of FMI 3.0, all of which a unit for co-simulation has to export.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <sstream>

#include "core/errors.h"
#include "core/files.h"
#include "tools/fmi/instance.h"

// NOLINTBEGIN(readability-identifier-naming)

namespace photorque::fmi {
namespace {

// resources/unit: the token, the experiment's path from there, and whether it has light.
struct Resources {
  std::string token;
  RunOptions options;
};

Resources read_resources(const std::filesystem::path& folder) {
  Resources resources;
  std::istringstream lines(read_file(folder / "unit"));
  std::string experiment, has_light;
  std::getline(lines, resources.token);
  std::getline(lines, experiment);
  std::getline(lines, has_light);
  resources.options.experiment = folder / experiment;
  // The folder of the table of light in the unit.
  if (has_light == "light") {
    resources.options.overrides.push_back("light.cache=\"" + (folder / "light").string() + "\"");
  }
  return resources;
}

}  // namespace
}  // namespace photorque::fmi

using namespace photorque;
using namespace photorque::fmi;

PHOTORQUE_EXPORT const char* fmi3GetVersion() {
  return "3.0";
}

PHOTORQUE_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean on, size_t count,
                                                const fmi3String categories[]) {
  return guarded(handle, "fmi3SetDebugLogging", [&](Instance& instance) {
    instance.tells_events = on && count == 0;
    for (size_t i = 0; i < count; ++i) {
      if (std::strcmp(categories[i], "logEvents") == 0) instance.tells_events = on;
    }
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean, fmi3Boolean logging,
    fmi3Boolean event_mode_used, fmi3Boolean, const fmi3ValueReference*, size_t intermediate,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback) {
  auto instance = std::make_unique<Instance>();
  instance->environment = environment;
  instance->log = log;
  instance->tells_events = logging;
  try {
    if (resource_path == nullptr || token == nullptr || name == nullptr) {
      throw NumericalError("name, token and path of the resources are needed");
    }
    const Resources resources = read_resources(resource_path);
    if (resources.token != token) {
      throw NumericalError("the token \"" + std::string(token) + "\" is not that of the unit, \"" +
                           resources.token + "\"");
    }
    if (event_mode_used || intermediate > 0) {
      throw NumericalError("the unit has neither an event mode nor intermediate updates");
    }
    instance->description = describe_unit(resources.options);
    instance->now_s = instance->start_s = instance->description.start_s;
    instance->stop_s = instance->description.stop_s;
    instance->run =
        std::make_unique<CoSimulation>(resources.options, instance->description.rate_Hz);
  } catch (const std::exception& error) {
    instance->refuse("fmi3InstantiateCoSimulation: " + std::string(error.what()));
    return nullptr;
  }
  return instance.release();
}

PHOTORQUE_EXPORT void fmi3FreeInstance(fmi3Instance handle) {
  delete static_cast<Instance*>(handle);
}

PHOTORQUE_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean,
                                                        fmi3Float64, fmi3Float64 start_s,
                                                        fmi3Boolean has_stop, fmi3Float64 stop_s) {
  return guarded(handle, "fmi3EnterInitializationMode", [&](Instance& instance) {
    if (instance.mode != Mode::instantiated) return instance.refuse("initialised already");
    const double usual_s = instance.description.stop_s - instance.description.start_s;
    instance.now_s = instance.start_s = start_s;
    instance.stop_s = has_stop ? stop_s : start_s + usual_s;
    if (!std::isfinite(start_s) || !(instance.stop_s >= start_s)) {
      return instance.refuse("a stop time before the start");
    }
    begin(instance, {});
    instance.mode = Mode::initialization;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance handle) {
  return guarded(handle, "fmi3ExitInitializationMode", [&](Instance& instance) {
    if (instance.mode != Mode::initialization) return instance.refuse("not being initialised");
    instance.mode = Mode::step;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3Terminate(fmi3Instance handle) {
  return guarded(handle, "fmi3Terminate", [&](Instance& instance) {
    instance.mode = Mode::terminated;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3Reset(fmi3Instance handle) {
  return guarded(handle, "fmi3Reset", [&](Instance& instance) {
    instance.mode = Mode::instantiated;
    instance.command_body_N_m = Vec3::Zero();
    instance.now_s = instance.description.start_s;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3DoStep(fmi3Instance handle, fmi3Float64 now_s, fmi3Float64 step_s,
                                       fmi3Boolean, fmi3Boolean* event, fmi3Boolean* terminate,
                                       fmi3Boolean* early, fmi3Float64* reached_s) {
  return guarded(handle, "fmi3DoStep", [&](Instance& instance) {
    const double tick_s = 1.0 / instance.description.rate_Hz;
    *event = *terminate = *early = false;
    *reached_s = instance.now_s;
    if (instance.mode != Mode::step) return instance.refuse("fmi3DoStep before initialisation");
    if (!(std::abs(now_s - instance.now_s) <= 1e-3 * tick_s) || !(step_s > 0.0) ||
        !(now_s + step_s <= instance.stop_s + 0.5 * tick_s)) {
      return instance.refuse("a step from " + std::to_string(now_s) + " s over " +
                             std::to_string(step_s) + " s, where the time is " +
                             std::to_string(instance.now_s) + " s and the run ends at " +
                             std::to_string(instance.stop_s) + " s");
    }
    instance.run->advance_to(now_s + step_s, instance.command_body_N_m);
    instance.tell_words();
    *terminate = instance.run->ended();
    *reached_s = instance.now_s = *terminate ? instance.run->tick_s() : now_s + step_s;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance handle, const fmi3ValueReference of[],
                                           size_t count, fmi3Float64 values[], size_t size) {
  return guarded(handle, "fmi3GetFloat64", [&](Instance& instance) {
    if (size != count) return instance.refuse("fmi3GetFloat64: every variable is one number");
    for (size_t i = 0; i < count; ++i) {
      const double* output = instance.run->outputs().number(of[i]);
      if (of[i] == time_reference) {
        values[i] = instance.now_s;
      } else if (of[i] - first_input_reference < 3) {
        values[i] = instance.command_body_N_m[of[i] - first_input_reference];
      } else if (output != nullptr) {
        values[i] = *output;
      } else {
        return instance.refuse("no number has the reference " + std::to_string(of[i]));
      }
    }
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance handle, const fmi3ValueReference of[],
                                           size_t count, const fmi3Float64 values[], size_t size) {
  return guarded(handle, "fmi3SetFloat64", [&](Instance& instance) {
    if (size != count) return instance.refuse("fmi3SetFloat64: every variable is one number");
    Vec3 command_body_N_m = instance.command_body_N_m;
    for (size_t i = 0; i < count; ++i) {
      const uint32_t axis = of[i] - first_input_reference;
      if (axis >= 3) return instance.refuse("no input has the reference " + std::to_string(of[i]));
      if (!(std::abs(values[i]) <= instance.description.max_torque_N_m)) {
        instance.say(fmi3Discard, "logStatusDiscard",
                     "a torque of " + std::to_string(values[i]) + " N m, beyond " +
                         std::to_string(instance.description.max_torque_N_m) +
                         " N m (serve.max_torque_N_m)");
        return fmi3Discard;
      }
      command_body_N_m[axis] = values[i];
    }
    instance.command_body_N_m = command_body_N_m;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3GetBoolean(fmi3Instance handle, const fmi3ValueReference of[],
                                           size_t count, fmi3Boolean values[], size_t size) {
  return guarded(handle, "fmi3GetBoolean", [&](Instance& instance) {
    if (size != count) return instance.refuse("fmi3GetBoolean: every variable is one value");
    for (size_t i = 0; i < count; ++i) {
      const bool* flag = instance.run->outputs().flag(of[i]);
      if (flag == nullptr) {
        return instance.refuse("no flag has the reference " + std::to_string(of[i]));
      }
      values[i] = *flag;
    }
    return fmi3OK;
  });
}

namespace photorque::fmi {
namespace {

// A state is the list of commands: the run is recomputed to its time.
struct UnitState {
  Mode mode = Mode::instantiated;
  double now_s = 0.0, start_s = 0.0, stop_s = 0.0;
  Vec3 command_body_N_m = Vec3::Zero();
  std::vector<Vec3> commands;
};

}  // namespace
}  // namespace photorque::fmi

PHOTORQUE_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState* to) {
  return guarded(handle, "fmi3GetFMUState", [&](Instance& instance) {
    auto* state = static_cast<UnitState*>(*to);
    if (state == nullptr) state = new UnitState;
    *state = {instance.mode,
              instance.now_s,
              instance.start_s,
              instance.stop_s,
              instance.command_body_N_m,
              instance.run->commands()};
    *to = state;
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState from) {
  return guarded(handle, "fmi3SetFMUState", [&](Instance& instance) {
    const auto* state = static_cast<const UnitState*>(from);
    if (state == nullptr) return instance.refuse("fmi3SetFMUState: no state");
    instance.now_s = state->now_s;
    instance.start_s = state->start_s;
    instance.stop_s = state->stop_s;
    instance.command_body_N_m = state->command_body_N_m;
    instance.mode = state->mode;
    if (instance.mode == Mode::instantiated) return fmi3OK;
    return begin(instance, state->commands);
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState* state) {
  return guarded(handle, "fmi3FreeFMUState", [&](Instance&) {
    delete static_cast<UnitState*>(*state);
    *state = nullptr;
    return fmi3OK;
  });
}

// Serialised: mode, three times, the command, then every command so far; doubles of this machine.
PHOTORQUE_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState from,
                                                       size_t* size) {
  return guarded(handle, "fmi3SerializedFMUStateSize", [&](Instance&) {
    *size = sizeof(double) * (7 + 3 * static_cast<const UnitState*>(from)->commands.size());
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState from,
                                                  fmi3Byte bytes[], size_t size) {
  return guarded(handle, "fmi3SerializeFMUState", [&](Instance& instance) {
    const auto& state = *static_cast<const UnitState*>(from);
    std::vector<double> all = {static_cast<double>(state.mode), state.now_s, state.start_s,
                               state.stop_s};
    const auto put = [&](const Vec3& v) { all.insert(all.end(), v.begin(), v.end()); };
    put(state.command_body_N_m);
    for (const Vec3& command : state.commands) put(command);
    if (size < all.size() * sizeof(double)) return instance.refuse("too few bytes for the state");
    std::memcpy(bytes, all.data(), all.size() * sizeof(double));
    return fmi3OK;
  });
}

PHOTORQUE_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte bytes[],
                                                    size_t size, fmi3FMUState* to) {
  return guarded(handle, "fmi3DeserializeFMUState", [&](Instance& instance) {
    std::vector<double> all(size / sizeof(double));
    std::memcpy(all.data(), bytes, all.size() * sizeof(double));
    // Some importers hand the bytes on as a text, with one that ends it.
    bool is_right = all.size() >= 7 && all.size() % 3 == 1 && size % sizeof(double) <= 1;
    for (const double value : all) is_right = is_right && std::isfinite(value);
    if (!is_right || !(all[0] >= 0.0 && all[0] <= 3.0)) {
      return instance.refuse("these bytes are no state of this unit");
    }
    auto state = std::make_unique<UnitState>();
    state->mode = static_cast<Mode>(static_cast<int>(all[0]));
    state->now_s = all[1], state->start_s = all[2], state->stop_s = all[3];
    state->command_body_N_m = Vec3(all[4], all[5], all[6]);
    for (size_t i = 7; i < all.size(); i += 3) {
      state->commands.emplace_back(all[i], all[i + 1], all[i + 2]);
    }
    *to = state.release();
    return fmi3OK;
  });
}

// The functions that the unit does not offer: they return fmi3Error. Importers look for every name.
#define PHOTORQUE_ABSENT(name)                                               \
  PHOTORQUE_EXPORT fmi3Status name(fmi3Instance handle) {                    \
    return guarded(handle, #name, [](Instance& instance) {                   \
      return instance.refuse(#name " is not offered: modelDescription.xml"); \
    });                                                                      \
  }
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
  Instance instance;
  instance.environment = environment;
  instance.log = log;
  instance.refuse(std::string(function) + ": the unit is for co-simulation alone");
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
