// propagate(): motion of the platform under its disturbances and light, with torques written in
// Python.
#include <pybind11/numpy.h>

#include <array>
#include <cmath>

#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/pages.h"
#include "python/bindings/results.h"
#include "tools/coupling/propagate.h"
#include "tools/pages/pages.h"

namespace photorque::python {
namespace {

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Inputs of a law: time, quaternion (w, x, y, z), angular rate.
constexpr size_t variables = 8;
using Variables = std::array<double, variables>;
using Torque = std::array<double, 3>;

// Evaluation of the function at many instants.
class Evaluation {
 public:
  Evaluation(std::string name, py::object function, Call::Failing failing)
      : name_(std::move(name)), function_(std::move(function)), failing_(std::move(failing)) {}

  // Called by the library without the interpreter's lock.
  std::vector<Torque> operator()(const std::vector<Variables>& instants) const {
    const py::gil_scoped_acquire lock;
    try {
      return evaluate(instants);
    } catch (py::error_already_set& error) {
      failing_(std::move(error));
    }
    return {};  // not reached: failing_ throws
  }

 private:
  std::vector<Torque> evaluate(const std::vector<Variables>& instants) const {
    const auto count = static_cast<py::ssize_t>(instants.size());
    py::array_t<double> time_s(count);
    py::array_t<double> attitude({count, py::ssize_t{4}}), rate({count, py::ssize_t{3}});
    for (py::ssize_t i = 0; i < count; ++i) {
      const Variables& x = instants[static_cast<size_t>(i)];
      time_s.mutable_at(i) = x[0];
      for (py::ssize_t k = 0; k < 4; ++k) attitude.mutable_at(i, k) = x[static_cast<size_t>(1 + k)];
      for (py::ssize_t k = 0; k < 3; ++k) rate.mutable_at(i, k) = x[static_cast<size_t>(5 + k)];
    }
    const Rows torques = Rows::ensure(function_(time_s, attitude, rate));
    if (!torques) fail("gave no array of numbers");
    if (torques.ndim() != 2 || torques.shape(0) != count || torques.shape(1) != 3) refuse(torques);
    std::vector<Torque> result(instants.size());
    for (py::ssize_t i = 0; i < count; ++i) {
      for (py::ssize_t k = 0; k < 3; ++k) {
        const double value = torques.at(i, k);
        if (!std::isfinite(value)) fail("gave a number that is not finite");
        result[static_cast<size_t>(i)][static_cast<size_t>(k)] = value;
      }
    }
    return result;
  }
  [[noreturn]] void refuse(const py::array& torques) const {
    fail("gave an array of shape " + std::string(py::str(torques.attr("shape"))) +
         ", expected (n, 3), a row for each time");
  }
  [[noreturn]] void fail(const std::string& what) const {
    PyErr_SetString(PyExc_ValueError, ("torque \"" + name_ + "\" " + what).c_str());
    throw py::error_already_set();
  }

  std::string name_;
  py::object function_;
  Call::Failing failing_;
};

class OwnTorque final : public TorqueLaw<OwnTorque> {
 public:
  explicit OwnTorque(Evaluation evaluate) : evaluate_(std::move(evaluate)) {}

  Vec3Of<Lanes> torque(const ParametersAndStates<Lanes>&,
                       const EvaluationContext<Lanes>& now) const {
    const std::vector<Torque> torques = evaluate_(instants_of(variables_of(now)));
    Vec3Of<Lanes> result = Vec3Of<Lanes>::Constant(Lanes(0.0));
    for (int i = 0; i < Lanes::count; ++i) {
      for (int k = 0; k < 3; ++k) {
        result[k].set(i, torques[static_cast<size_t>(i)][static_cast<size_t>(k)]);
      }
    }
    return result;
  }

  // Derivatives by central differences in every variable, in a single call.
  Vec3Of<DualLanes> torque(const ParametersAndStates<DualLanes>&,
                           const EvaluationContext<DualLanes>& now) const {
    const std::array<DualLanes, variables> x = variables_of(now);
    std::array<Lanes, variables> values;
    for (size_t v = 0; v < variables; ++v) values[v] = x[v].value;
    std::vector<Variables> instants = instants_of(values);
    const size_t count = instants.size();
    for (size_t v = 0; v < variables; ++v) {
      for (const double sign : {1.0, -1.0}) {
        for (size_t i = 0; i < count; ++i) {
          Variables moved = instants[i];
          moved[v] += sign * step;
          instants.push_back(moved);
        }
      }
    }
    const std::vector<Torque> torques = evaluate_(instants);
    Vec3Of<DualLanes> result;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](size_t block) { return lanes_of(torques, block * count, k); };
      DualLanes sum(at(0));
      for (size_t v = 0; v < variables; ++v) {
        const Lanes slope = (0.5 / step) * (at(1 + 2 * v) - at(2 + 2 * v));
        sum += DualLanes::chain(x[v], 0.0, slope);
      }
      result[k] = sum;
    }
    return result;
  }

 private:
  // Step in seconds, quaternion components and rad/s: about the cube root of the rounding error.
  static constexpr double step = 1e-5;

  template <class T>
  static std::array<T, variables> variables_of(const EvaluationContext<T>& now) {
    const QuatOf<T>& q = now.attitude;
    const Vec3Of<T>& rate = now.rate_body_rad_s;
    return {now.time_s, q.w(), q.x(), q.y(), q.z(), rate[0], rate[1], rate[2]};
  }
  static std::vector<Variables> instants_of(const std::array<Lanes, variables>& x) {
    std::vector<Variables> instants(Lanes::count);
    for (int i = 0; i < Lanes::count; ++i) {
      for (size_t v = 0; v < variables; ++v) instants[static_cast<size_t>(i)][v] = x[v][i];
    }
    return instants;
  }
  static Lanes lanes_of(const std::vector<Torque>& torques, size_t first, int component) {
    Lanes lanes(0.0);
    for (int i = 0; i < Lanes::count; ++i) {
      lanes.set(i, torques[first + static_cast<size_t>(i)][static_cast<size_t>(component)]);
    }
    return lanes;
  }

  Evaluation evaluate_;
};

// A torque written in Python, for experiments before a new kind is implemented.
// `function(time_s, attitude_wxyz, rate_body_rad_s)` receives arrays of shape (n,), (n, 4), (n, 3).
// It returns the torques about the centre of rotation in body axes [N m], shape (n, 3). Each row
// must depend only on its own instant, and smoothly. The function is called with the interpreter's
// lock, which costs about ten microseconds per eight instants; derivatives are computed by
// differences. An exception in it ends the call.
Disturbance own_torque(const std::string& name, const py::object& function, const Call& call) {
  Disturbance disturbance;
  disturbance.kind = name;
  disturbance.law = std::make_shared<const OwnTorque>(Evaluation(name, function, call.failing()));
  return disturbance;
}

struct MotionHandle : MotionRun {
  RunOptions options;
};

// Source text of a function, if Python has it.
std::string source_of(const py::object& function) {
  try {
    return py::str(py::module_::import("inspect").attr("getsource")(function));
  } catch (const py::error_already_set&) {
    return "unknown";
  }
}

MotionHandle propagate_motion(const ExperimentHandle& experiment, int threads,
                              const py::object& seed, const py::dict& torques,
                              const py::object& progress, const py::object& log) {
  const RunOptions options = experiment.with(threads, seed);
  const Call call(options.experiment, progress, log);
  FurtherTorques further;
  for (const auto& [name, function] : torques) {
    const std::string text = text_of(name, "torques", "names of torques");
    const auto law = py::reinterpret_borrow<py::object>(function);
    further.disturbances.push_back(own_torque(text, law, call));
    further.inputs.emplace_back("torque " + text, content_hash(source_of(law)));
  }
  return call.run([&] {
    return MotionHandle{run_propagate(options, call.console(), further), options};
  });
}

const PropagationResult& motion_of(const py::object& self) {
  return self.cast<const MotionHandle&>().coupled->motion;
}

py::dict recording_of(const py::object& self) {
  const Recording& recording = motion_of(self).recording;
  py::dict channels;
  channels["t_s"] = view(recording.time_s, self);
  for (const Channel& channel : recording.channels) {
    channels[py::str(channel.name)] = view(channel.values, self);
  }
  return channels;
}

// A view of `width` consecutive numbers in every state, from `first` on.
py::array state_view(const py::object& self, const double* first, py::ssize_t width) {
  const auto rows = static_cast<py::ssize_t>(motion_of(self).states.size());
  const auto stride = static_cast<py::ssize_t>(sizeof(PlatformState));
  if (width == 1) return view(first, {rows}, {stride}, self);
  return view(first, {rows, width}, {stride, static_cast<py::ssize_t>(sizeof(double))}, self);
}

py::array attitude_of(const py::object& self) {
  const std::vector<PlatformState>& states = motion_of(self).states;
  py::array_t<double> array({static_cast<py::ssize_t>(states.size()), py::ssize_t{4}});
  auto numbers = array.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < numbers.shape(0); ++i) {
    const Quat& q = states[static_cast<size_t>(i)].lab_from_body;
    const double wxyz[] = {q.w(), q.x(), q.y(), q.z()};
    for (py::ssize_t k = 0; k < 4; ++k) numbers(i, k) = wxyz[k];
  }
  return array;
}

py::list events_of(const MotionHandle& run) {
  py::list events;
  for (const Event& event : run.coupled->motion.events) {
    events.append(py::make_tuple(event.name, event.time_s));
  }
  return events;
}

}  // namespace

void bind_motion(py::module_& module) {
  auto type = py::class_<MotionHandle>(
      module, "Motion",
      "The motion of the platform: states, events and readings of the instruments.");
  add_result(type, "propagate");
  type.def_property_readonly("history", table_view<MotionHandle>("time_history"),
                             "Table over time: tilt, heading, yaw, rates, charge, every torque.")
      .def_property_readonly("recording", &recording_of,
                             "Channels of camera, gyro and power, as in recording.csv.")
      .def_property_readonly("events", &events_of, "(name, time_s) in order of time.")
      .def_property_readonly(
          "time_s",
          [](const py::object& self) {
            return state_view(self, &motion_of(self).states.front().time_s, 1);
          },
          "Times of the true states [s], shape (n,).")
      .def_property_readonly(
          "attitude_wxyz", &attitude_of,
          "Quaternions (w, x, y, z) that rotate body vectors into the lab; a copy.")
      .def_property_readonly(
          "rate_body_rad_s",
          [](const py::object& self) {
            return state_view(self, motion_of(self).states.front().rate_body_rad_s.data(), 3);
          },
          "Rates with respect to the lab, body axes [rad/s], shape (n, 3).")
      .def(
          "write_page",
          [](const MotionHandle& self, const std::filesystem::path& path) {
            return write_alone(path, [&] {
              return motion_page(self, self.options, head_of(self.options, "propagate"));
            });
          },
          py::arg("path"), "Writes the motion as one HTML page; returns its path.")
      .def_property_readonly(
          "charge_drawn_C",
          [](const py::object& self) {
            return state_view(self, &motion_of(self).states.front().charge_drawn_C, 1);
          },
          "Charge drawn from the battery [C], shape (n,).");
  module.def(
      "propagate", &propagate_motion, py::arg("experiment"), py::kw_only(), py::arg("threads") = 0,
      py::arg("seed") = py::none(), py::arg("torques") = py::dict(),
      py::arg("progress") = py::none(), py::arg("log") = py::none(),
      "Motion of the platform under its disturbances and the light of its scene.\n\n"
      "`torques`: additional torques by name: function(time_s (n,), attitude_wxyz (n, 4), "
      "rate_body_rad_s (n, 3)) returns torques (n, 3) [N m] about the centre of rotation, body "
      "axes.");
}

}  // namespace photorque::python
