// One call from Python into the library: other Python threads can run, progress is reported, Ctrl-C
// ends the run.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "core/errors.h"
#include "tools/runs/console.h"

namespace photorque::python {

namespace py = pybind11;

class Call {
 public:
  // `progress(task, fraction)` and `log(line)` are called on the calling thread; each may be None.
  Call(std::filesystem::path experiment, py::object progress, py::object log);
  ~Call();

  // Console for the run. An exception of a callback, and Ctrl-C, end the run at the next report.
  Console console() const;

  // For code of the run that calls Python: ends the run with the error of that call. Always throws.
  using Failing = std::function<void(py::error_already_set)>;
  Failing failing() const;

  // Throws the exception that a callback raised, if any.
  void rethrow_python() const;

  // Calls `work()` without the interpreter's lock. An InputError without a file gets the
  // experiment's name, as in the program's messages.
  template <class Work>
  auto run(const Work& work) const {
    std::optional<decltype(work())> result;
    try {
      const py::gil_scoped_release release;
      result.emplace(work());
    } catch (const InputError& error) {
      rethrow_python();
      throw named(error);
    } catch (const NumericalError&) {
      rethrow_python();
      throw;
    }
    rethrow_python();
    return std::move(*result);
  }

 private:
  struct State;
  InputError named(const InputError& error) const;
  std::shared_ptr<State> state_;
};

}  // namespace photorque::python
