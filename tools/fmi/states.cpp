// The functions of FMI 3.0 for the state of a unit.
#include <cmath>
#include <cstring>

#include "tools/fmi/instance.h"

// NOLINTBEGIN(readability-identifier-naming)
namespace photorque::fmi {
namespace {

// A state is all that a run follows from: it is run again until there.
struct UnitState {
  Mode mode = Mode::instantiated;
  double now_s = 0.0, start_s = 0.0, stop_s = 0.0;
  Vec3 command_body_N_m = Vec3::Zero();
  std::vector<Vec3> commands;
};

}  // namespace
}  // namespace photorque::fmi

using namespace photorque;
using namespace photorque::fmi;

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

// NOLINTEND(readability-identifier-naming)
