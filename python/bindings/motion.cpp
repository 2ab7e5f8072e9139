// propagate(): motion of the platform under its disturbances and light.
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/pages.h"
#include "python/bindings/results.h"
#include "python/bindings/torque.h"
#include "tools/coupling/propagate.h"
#include "tools/pages/pages.h"

namespace photorque::python {
namespace {

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
      "Propagates the platform through its disturbances, in the light of its scene.\n\n"
      "`torques`: laws to try out, by name: function(time_s (n,), attitude_wxyz (n, 4), "
      "rate_body_rad_s (n, 3)) gives torques (n, 3) in N m, body axes. Slow: a law that stays "
      "belongs into the catalogue.");
}

}  // namespace photorque::python
