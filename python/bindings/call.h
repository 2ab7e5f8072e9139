// One call from Python into the library: other Python threads go on meanwhile, progress is
// reported, Ctrl-C ends the run.
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
  // `progress(task, fraction)` and `log(line)` are called on the calling thread, or None.
  Call(std::filesystem::path experiment, py::object progress, py::object log);
  ~Call();

  // To be handed to the run. What a callback raises, and Ctrl-C, ends the run at the next word.
  Console console() const;

  // For code of the run that calls Python and meets an error there: ends the run with it. Always
  // throws.
  using Failing = std::function<void(py::error_already_set)>;
  Failing failing() const;

  // Throws what a callback raised, if one did.
  void rethrow_python() const;

  // `work()` without the interpreter's lock. An error of the input that names no file gets that of
  // the experiment, as the program says it.
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
