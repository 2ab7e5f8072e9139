#include "python/bindings/call.h"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

namespace photorque::python {

struct Call::State {
  std::filesystem::path experiment;
  py::object progress, log;
  std::thread::id caller = std::this_thread::get_id();
  std::chrono::steady_clock::time_point last = {};
  std::string task;  // task whose last reported fraction was below 1
  std::optional<py::error_already_set> raised = {};
  std::atomic<bool> stopped = false;

  // Throws if the run was stopped. Call::run() replaces this exception by the Python error.
  void go_on() const {
    if (stopped) throw NumericalError("interrupted");
  }

  // Requires the interpreter's lock. Handles signals, then calls `report`; an exception ends the
  // run.
  template <class Report>
  void call_report(const Report& report) {
    try {
      if (raised || PyErr_CheckSignals() != 0) {
        if (!raised) raised.emplace();
      } else {
        report();
      }
    } catch (py::error_already_set& error) {
      raised.emplace(std::move(error));
    }
    stopped = raised.has_value();
    go_on();
  }
};

Call::Call(std::filesystem::path experiment, py::object progress, py::object log)
    : state_(std::make_shared<State>()) {
  state_->experiment = std::move(experiment);
  state_->progress = std::move(progress);
  state_->log = std::move(log);
}

Call::~Call() = default;

Console Call::console() const {
  // Worker threads of the library also report. They do not wait for the lock or handle signals, but
  // stop when the caller has stopped.
  const auto is_caller = [state = state_.get()] {
    return std::this_thread::get_id() == state->caller;
  };
  ConsoleSinks sinks;
  sinks.progress = [state = state_.get(), is_caller](const std::string& what, double fraction) {
    if (!is_caller()) return state->go_on();
    const auto now = std::chrono::steady_clock::now();
    if (now - state->last < std::chrono::milliseconds(50) && fraction < 1.0) return;
    state->last = now;
    state->task = fraction < 1.0 ? what : std::string();
    const py::gil_scoped_acquire lock;
    state->call_report([&] {
      if (!state->progress.is_none()) state->progress(what, fraction);
    });
  };
  sinks.done = [state = state_.get(), is_caller] {
    if (!is_caller() || state->task.empty()) return;
    const py::gil_scoped_acquire lock;
    state->call_report([&] {
      if (!state->progress.is_none()) state->progress(std::exchange(state->task, {}), 1.0);
    });
  };
  sinks.line = [state = state_.get(), is_caller](const std::string& text) {
    if (!is_caller()) return state->go_on();
    const py::gil_scoped_acquire lock;
    state->call_report([&] {
      if (!state->log.is_none()) state->log(text);
    });
  };
  return Console(std::move(sinks));
}

Call::Failing Call::failing() const {
  return [state = state_](py::error_already_set error) {
    if (!state->raised) state->raised.emplace(std::move(error));
    state->stopped = true;
    state->go_on();
  };
}

void Call::rethrow_python() const {
  if (!state_->raised) return;
  py::error_already_set error = std::move(*state_->raised);
  state_->raised.reset();
  throw error;
}

InputError Call::named(const InputError& error) const {
  const std::string what = error.what();
  if (error.names_file() || what.starts_with("--")) return error;
  return InputError({state_->experiment.string()}, what, "", "");
}

}  // namespace photorque::python
