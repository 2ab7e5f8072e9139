#include "tools/fmi/instance.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "core/errors.h"
#include "core/files.h"

namespace photorque::fmi {
namespace {

// Content of resources/unit: the token, the relative path of the experiment, and whether it has
// light.
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
  // Folder of the table of light in the unit.
  if (has_light == "light") {
    resources.options.overrides.push_back("light.cache=\"" + (folder / "light").string() + "\"");
  }
  return resources;
}

}  // namespace

std::vector<double> UnitState::numbers() const {
  std::vector<double> all = {static_cast<double>(mode), now_s, start_s, stop_s};
  const auto put = [&](const Vec3& v) { all.insert(all.end(), v.begin(), v.end()); };
  put(command_body_N_m);
  for (const Vec3& command : commands) put(command);
  return all;
}

std::unique_ptr<UnitState> UnitState::from(const void* bytes, size_t size) {
  std::vector<double> all(size / sizeof(double));
  std::memcpy(all.data(), bytes, all.size() * sizeof(double));
  // Some importers pass the bytes as a text with a terminating zero byte.
  bool is_right = all.size() >= 7 && all.size() % 3 == 1 && size % sizeof(double) <= 1;
  for (const double value : all) is_right = is_right && std::isfinite(value);
  if (!is_right || !(all[0] >= 0.0 && all[0] <= 3.0)) return nullptr;
  auto state = std::make_unique<UnitState>();
  state->mode = static_cast<Mode>(static_cast<int>(all[0]));
  state->now_s = all[1], state->start_s = all[2], state->stop_s = all[3];
  state->command_body_N_m = Vec3(all[4], all[5], all[6]);
  for (size_t i = 7; i < all.size(); i += 3) {
    state->commands.emplace_back(all[i], all[i + 1], all[i + 2]);
  }
  return state;
}

Instance::Instance(const std::string& resource_folder, const std::string& token, bool logs_events,
                   LogSink log)
    : log_(std::move(log)), logs_events_(logs_events) {
  const Resources resources = read_resources(resource_folder);
  if (resources.token != token) {
    throw NumericalError("the token \"" + token + "\" is not that of the unit, \"" +
                         resources.token + "\"");
  }
  description_ = describe_unit(resources.options);
  now_s_ = start_s_ = planned_start_s_ = description_.start_s;
  stop_s_ = description_.stop_s;
  run_ = std::make_unique<CoSimulation>(resources.options, description_.rate_Hz);
}

void Instance::log_message(fmi3Status status, const char* category,
                           const std::string& message) const {
  if (log_) log_(status, category, message.c_str());
}

fmi3Status Instance::refuse(const std::string& message) const {
  log_message(fmi3Error, "logStatusError", message);
  return fmi3Error;
}

void Instance::log_messages() {
  for (const std::string& line : run_->take_messages()) {
    if (logs_events_ && !line.empty()) log_message(fmi3OK, "logEvents", line);
  }
}

fmi3Status Instance::set_debug_logging(bool on, size_t count, const char* const categories[]) {
  logs_events_ = on && count == 0;
  for (size_t i = 0; i < count; ++i) {
    if (std::strcmp(categories[i], "logEvents") == 0) logs_events_ = on;
  }
  return fmi3OK;
}

fmi3Status Instance::begin(std::vector<Vec3> commands) {
  run_->begin(start_s_, stop_s_, std::move(commands));
  log_messages();
  return fmi3OK;
}

fmi3Status Instance::set_up(double start_s, std::optional<double> stop_s) {
  planned_start_s_ = start_s;
  planned_stop_s_ = stop_s;
  return fmi3OK;
}

fmi3Status Instance::enter_initialization() {
  if (mode_ != Mode::instantiated) return refuse("initialised already");
  const double usual_s = description_.stop_s - description_.start_s;
  now_s_ = start_s_ = planned_start_s_;
  stop_s_ = planned_stop_s_.value_or(start_s_ + usual_s);
  if (!std::isfinite(start_s_) || !(stop_s_ >= start_s_)) {
    return refuse("a stop time before the start");
  }
  begin({});
  mode_ = Mode::initialization;
  return fmi3OK;
}

fmi3Status Instance::exit_initialization() {
  if (mode_ != Mode::initialization) return refuse("not being initialised");
  mode_ = Mode::step;
  return fmi3OK;
}

fmi3Status Instance::terminate() {
  mode_ = Mode::terminated;
  return fmi3OK;
}

fmi3Status Instance::reset() {
  mode_ = Mode::instantiated;
  command_body_N_m_ = Vec3::Zero();
  now_s_ = description_.start_s;
  has_ended_ = false;
  return set_up(description_.start_s, std::nullopt);
}

fmi3Status Instance::step(double now_s, double step_s) {
  const double tick_s = 1.0 / description_.rate_Hz;
  has_ended_ = false;
  if (mode_ != Mode::step) return refuse("a step before the end of the initialisation");
  if (!(std::abs(now_s - now_s_) <= 1e-3 * tick_s) || !(step_s > 0.0) ||
      !(now_s + step_s <= stop_s_ + 0.5 * tick_s)) {
    return refuse("a step from " + std::to_string(now_s) + " s over " + std::to_string(step_s) +
                  " s, where the time is " + std::to_string(now_s_) + " s and the run ends at " +
                  std::to_string(stop_s_) + " s");
  }
  run_->advance_to(now_s + step_s, command_body_N_m_);
  log_messages();
  has_ended_ = run_->ended();
  now_s_ = has_ended_ ? run_->tick_s() : now_s + step_s;
  return fmi3OK;
}

fmi3Status Instance::get_numbers(std::span<const uint32_t> references, double* values) const {
  for (const uint32_t reference : references) {
    const double* output = run_->outputs().number(reference);
    if (reference == time_reference) {
      *values++ = now_s_;
    } else if (reference - first_input_reference < 3) {
      *values++ = command_body_N_m_[reference - first_input_reference];
    } else if (output != nullptr) {
      *values++ = *output;
    } else {
      return refuse("no number has the reference " + std::to_string(reference));
    }
  }
  return fmi3OK;
}

fmi3Status Instance::set_numbers(std::span<const uint32_t> references, const double* values) {
  Vec3 command_body_N_m = command_body_N_m_;
  for (const uint32_t reference : references) {
    const uint32_t axis = reference - first_input_reference;
    if (axis >= 3) return refuse("no input has the reference " + std::to_string(reference));
    const double torque_N_m = *values++;
    if (!(std::abs(torque_N_m) <= description_.max_torque_N_m)) {
      log_message(fmi3Discard, "logStatusDiscard",
                  "a torque of " + std::to_string(torque_N_m) + " N m, beyond " +
                      std::to_string(description_.max_torque_N_m) + " N m (serve.max_torque_N_m)");
      return fmi3Discard;
    }
    command_body_N_m[axis] = torque_N_m;
  }
  command_body_N_m_ = command_body_N_m;
  return fmi3OK;
}

const bool* Instance::flag(uint32_t reference) const {
  const bool* flag = run_->outputs().flag(reference);
  if (flag == nullptr) refuse("no flag has the reference " + std::to_string(reference));
  return flag;
}

fmi3Status Instance::save_state(void** to) const {
  if (*to == nullptr) *to = new UnitState;
  *static_cast<UnitState*>(*to) = {mode_,           now_s_, start_s_, stop_s_, command_body_N_m_,
                                   run_->commands()};
  return fmi3OK;
}

fmi3Status Instance::restore_state(const char* function, const void* from) {
  if (from == nullptr) return refuse(std::string(function) + ": no state");
  const auto& state = *static_cast<const UnitState*>(from);
  has_ended_ = false;
  now_s_ = state.now_s;
  start_s_ = state.start_s;
  stop_s_ = state.stop_s;
  command_body_N_m_ = state.command_body_N_m;
  mode_ = state.mode;
  if (mode_ == Mode::instantiated) return fmi3OK;
  return begin(state.commands);
}

fmi3Status Instance::free_state(void** state) const {
  delete static_cast<UnitState*>(*state);
  *state = nullptr;
  return fmi3OK;
}

fmi3Status Instance::find_state_size(const void* state, size_t* bytes) const {
  *bytes = sizeof(double) * static_cast<const UnitState*>(state)->numbers().size();
  return fmi3OK;
}

fmi3Status Instance::write_state(const void* state, void* bytes, size_t size) const {
  const std::vector<double> all = static_cast<const UnitState*>(state)->numbers();
  if (size < all.size() * sizeof(double)) return refuse("too few bytes for the state");
  std::memcpy(bytes, all.data(), all.size() * sizeof(double));
  return fmi3OK;
}

fmi3Status Instance::read_state(const void* bytes, size_t size, void** to) const {
  std::unique_ptr<UnitState> state = UnitState::from(bytes, size);
  if (state == nullptr) return refuse("these bytes are no state of this unit");
  *to = state.release();
  return fmi3OK;
}

Instance* instantiate(const char* function, const char* name, const char* token,
                      const char* resources, bool logs_events, const LogSink& log) {
  try {
    if (resources == nullptr || token == nullptr || name == nullptr) {
      throw NumericalError("name, token and path of the resources are needed");
    }
    return std::make_unique<Instance>(resources, token, logs_events, log).release();
  } catch (const std::exception& error) {
    if (log)
      log(fmi3Error, "logStatusError", (std::string(function) + ": " + error.what()).c_str());
    return nullptr;
  }
}

}  // namespace photorque::fmi
