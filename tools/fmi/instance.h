// An instance of the unit: implementation of the functions of FMI 2.0 and 3.0.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/fmi/standard.h"
#include "tools/fmi/unit.h"

// Exports a function for importers.
#define PHOTORQUE_EXPORT extern "C" __attribute__((visibility("default")))

// Exports a function that the unit does not support: it returns an error. It must exist, because
// importers look up every name.
#define PHOTORQUE_ABSENT(name)                                               \
  PHOTORQUE_EXPORT fmi3Status name(void* handle) {                           \
    return guarded(handle, #name, [](const Instance& instance) {             \
      return instance.refuse(#name " is not offered: modelDescription.xml"); \
    });                                                                      \
  }

namespace photorque::fmi {

enum class Mode { instantiated, initialization, step, terminated };

using LogSink = std::function<void(fmi3Status status, const char* category, const char* message)>;

// A state is the list of commands: restoring it repeats the run up to its time.
struct UnitState {
  Mode mode = Mode::instantiated;
  double now_s = 0.0, start_s = 0.0, stop_s = 0.0;
  Vec3 command_body_N_m = Vec3::Zero();
  std::vector<Vec3> commands;

  // Mode, three times, the command, then all commands so far, as doubles in the format of this
  // machine.
  std::vector<double> numbers() const;
  // Null if the bytes are not a valid state.
  static std::unique_ptr<UnitState> from(const void* bytes, size_t size);
};

class Instance {
 public:
  // `resources`: the folder of that name in the unit. Throws InputError or NumericalError for a
  // wrong token or an experiment that cannot run.
  Instance(const std::string& resources, const std::string& token, bool logs_events, LogSink log);

  // Times of the run; without a stop time it lasts as long as that of the experiment.
  fmi3Status set_up(double start_s, std::optional<double> stop_s);
  fmi3Status enter_initialization();
  fmi3Status exit_initialization();
  fmi3Status terminate();
  fmi3Status reset();
  fmi3Status step(double now_s, double step_s);
  fmi3Status get_numbers(std::span<const uint32_t> references, double* values) const;
  fmi3Status set_numbers(std::span<const uint32_t> references, const double* values);
  // `Flag`: the Boolean type of the FMI version.
  template <typename Flag>
  fmi3Status get_flags(std::span<const uint32_t> references, Flag* values) const {
    for (const uint32_t reference : references) {
      const bool* value = flag(reference);
      if (value == nullptr) return fmi3Error;
      *values++ = static_cast<Flag>(*value);
    }
    return fmi3OK;
  }

  // States are pointers to UnitState for the importer: save_state() allocates one if `*to` is null,
  // and free_state() deletes it. `function` is named in messages.
  fmi3Status save_state(void** to) const;
  fmi3Status restore_state(const char* function, const void* from);
  fmi3Status free_state(void** state) const;
  fmi3Status find_state_size(const void* state, size_t* bytes) const;
  fmi3Status write_state(const void* state, void* bytes, size_t size) const;
  fmi3Status read_state(const void* bytes, size_t size, void** to) const;

  double now_s() const { return now_s_; }
  // Whether the platform has reached its stop in the last step, at now_s().
  bool has_ended() const { return has_ended_; }
  fmi3Status set_debug_logging(bool on, size_t count, const char* const categories[]);
  fmi3Status refuse(const std::string& message) const;
  // Makes further steps impossible.
  void give_up() { mode_ = Mode::terminated; }

 private:
  void log_message(fmi3Status status, const char* category, const std::string& message) const;
  void log_messages();
  // Null, with a message, if no flag has the reference.
  const bool* flag(uint32_t reference) const;
  // Restarts the run and repeats `commands`.
  fmi3Status begin(std::vector<Vec3> commands);

  LogSink log_;
  bool logs_events_ = false, has_ended_ = false;
  Mode mode_ = Mode::instantiated;
  UnitDescription description_;
  std::unique_ptr<CoSimulation> run_;
  Vec3 command_body_N_m_ = Vec3::Zero();
  double now_s_ = 0.0, start_s_ = 0.0, stop_s_ = 0.0;
  double planned_start_s_ = 0.0;
  std::optional<double> planned_stop_s_;
};

// Calls a member function of Instance, or a function with an Instance argument, with the arguments.
// Converts exceptions, which must not leave the unit, to a status.
template <typename Body, typename... Arguments>
fmi3Status guarded(void* handle, const char* function, Body body, Arguments... arguments) {
  auto* instance = static_cast<Instance*>(handle);
  if (instance == nullptr) return fmi3Error;
  try {
    return std::invoke(body, *instance, arguments...);
  } catch (const std::exception& error) {
    instance->give_up();
    return instance->refuse(std::string(function) + ": " + error.what());
  }
}

// Creates an instance. Returns null, with a message to `log`, if this fails. Null arguments are
// errors.
Instance* instantiate(const char* function, const char* name, const char* token,
                      const char* resources, bool logs_events, const LogSink& log);

}  // namespace photorque::fmi
