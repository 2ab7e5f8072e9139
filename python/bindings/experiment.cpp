#include "python/bindings/experiment.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/errors.h"
#include "python/bindings/call.h"
#include "scenes/experiment/document.h"
#include "tools/verbs/check.h"

namespace photorque::python {
namespace {

// Conversion of Python values to settings and back: dict, list, tuple, str, bool, int, float, and
// NumPy's types. `key` names the value in errors. Throws InputError for values that experiments do
// not support.
SettingsNode settings_of(const py::handle& value, const std::string& key);
py::object value_of(const SettingsNode& node);

SettingsNode table_of(const py::dict& dict, const std::string& key) {
  SettingsNode::Table table;
  for (const auto& [name, value] : dict) {
    const std::string text = text_of(name, key, "keys that are texts");
    std::string below = key;
    below.append(key.empty() ? "" : ".").append(text);
    table.emplace(text, settings_of(value, below));
  }
  return {table};
}

SettingsNode array_of(const py::handle& items, const std::string& key) {
  SettingsNode::Array array;
  for (const py::handle item : items) {
    array.push_back(settings_of(item, key + "[" + std::to_string(array.size()) + "]"));
  }
  return {array};
}

struct ToPython {
  py::object operator()(bool value) const { return py::bool_(value); }
  py::object operator()(int64_t value) const { return py::int_(value); }
  py::object operator()(double value) const { return py::float_(value); }
  py::object operator()(const std::string& value) const { return py::str(value); }
  py::object operator()(const SettingsNode::Array& items) const {
    py::list list;
    for (const SettingsNode& item : items) list.append(value_of(item));
    return list;
  }
  py::object operator()(const SettingsNode::Table& table) const {
    py::dict dict;
    for (const auto& [key, value] : table) dict[py::str(key)] = value_of(value);
    return dict;
  }
};

SettingsNode settings_of(const py::handle& value, const std::string& key) {
  if (py::isinstance<py::bool_>(value)) return {value.cast<bool>()};
  if (py::isinstance<py::int_>(value)) {
    try {
      return {value.cast<int64_t>()};
    } catch (const py::cast_error&) {
      throw InputError({}, key, py::str(py::repr(value)), "a whole number of 64 bits");
    }
  }
  if (py::isinstance<py::float_>(value)) return {value.cast<double>()};
  if (py::isinstance<py::str>(value)) return {text_of(value, key, "a text")};
  if (py::isinstance<py::dict>(value)) {
    return table_of(py::reinterpret_borrow<py::dict>(value), key);
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    return array_of(value, key);
  }
  // NumPy arrays and numbers become Python values; paths become texts.
  if (py::hasattr(value, "tolist")) return settings_of(value.attr("tolist")(), key);
  if (py::hasattr(value, "__fspath__")) return settings_of(value.attr("__fspath__")(), key);
  throw InputError({}, key, py::str(py::repr(value)),
                   "a number, text, truth value, list or dict of such");
}

py::object value_of(const SettingsNode& node) {
  return std::visit(ToPython{}, node.value);
}

ExperimentHandle changed(ExperimentHandle experiment, const py::dict& keys) {
  for (const auto& [key, value] : keys) {
    const std::string name = text_of(key, "keys", "names of keys");
    experiment.options.overrides.push_back(name + "=" + toml_value(settings_of(value, name)));
  }
  experiment.options.settings(experiment.options.overrides);
  return experiment;
}

ExperimentHandle make(const py::object& source, const py::dict& keys,
                      const std::optional<std::filesystem::path>& folder, const std::string& name) {
  ExperimentHandle experiment;
  RunOptions& options = experiment.options;
  if (py::isinstance<py::dict>(source)) {
    options.experiment = folder.value_or("") / (name + ".toml");
    options.text = toml_document(std::get<SettingsNode::Table>(settings_of(source, "").value));
  } else {
    if (folder) {
      throw InputError({}, "folder", "a folder beside a file", "one of the two");
    }
    try {
      options.experiment = source.cast<std::filesystem::path>();
    } catch (const py::cast_error&) {
      throw InputError({}, "source", py::str(py::repr(source)), "the path of a file, or a dict");
    }
    options.text = options.experiment_text();
  }
  return changed(std::move(experiment), keys);
}

CheckReport check_of(const ExperimentHandle& experiment) {
  const Call call(experiment.options.experiment, py::none(), py::none());
  return call.run([&] { return run_check(experiment.options); });
}

}  // namespace

std::string text_of(const py::handle& text, const std::string& key, const std::string& expected) {
  try {
    if (py::isinstance<py::str>(text)) return text.cast<std::string>();
  } catch (const py::cast_error&) {
    // A text that cannot be encoded as UTF-8.
  }
  throw InputError({}, key, py::str(py::repr(text)), expected);
}

RunOptions ExperimentHandle::with(int threads, const py::object& seed) const {
  if (threads < 0 || threads > 1024) {
    throw InputError({}, "threads", std::to_string(threads), "a number in [0, 1024], 0: all");
  }
  RunOptions full = options;
  full.threads = threads;
  if (!seed.is_none()) {
    const SettingsNode node = settings_of(seed, "seed");
    const auto* whole = std::get_if<int64_t>(&node.value);
    if (whole == nullptr || *whole < 0) {
      throw InputError({}, "seed", describe(node), "a whole number that is not negative");
    }
    full.seed = static_cast<uint64_t>(*whole);
  }
  return full;
}

void bind_experiment(py::module_& module) {
  py::class_<ExperimentHandle>(module, "Experiment",
                               "The nominal model of a laboratory: an experiment file, or a dict "
                               "with the same keys.\n\n"
                               "Files that a dict names are relative to `folder`. Values are "
                               "checked when a run reads them, as by the program.")
      .def(py::init(&make), py::arg("source"), py::kw_only(), py::arg("keys") = py::dict(),
           py::arg("folder") = py::none(), py::arg("name") = "experiment")
      .def("with_keys", &changed, py::arg("keys"),
           "A copy with changed keys: {\"attitude.tilt_deg\": 30, \"source[0].power_W\": 10}, as "
           "the program's --set.")
      .def_property_readonly(
          "path", [](const ExperimentHandle& self) { return self.options.experiment.string(); },
          "Path of the file; for a dict, the name used in error messages.")
      .def_property_readonly(
          "text", [](const ExperimentHandle& self) { return *self.options.text; },
          "TOML as written, without the changes of keys.")
      .def_property_readonly(
          "changes", [](const ExperimentHandle& self) { return self.options.overrides; },
          "KEY=VALUE of every change, in order.")
      .def(
          "to_dict",
          [](const ExperimentHandle& self) {
            return value_of(self.options.settings(self.options.overrides));
          },
          "All keys as written, with the changes.")
      .def("__repr__", [](const ExperimentHandle& self) {
        return "Experiment(\"" + self.options.experiment.string() + "\"" +
               (self.options.overrides.empty()
                    ? ")"
                    : ", " + std::to_string(self.options.overrides.size()) + " keys changed)");
      });
  py::class_<CheckReport>(module, "CheckReport",
                          "Errors of an experiment, and the commands that can run with it.")
      .def_property_readonly(
          "commands",
          [](const CheckReport& report) {
            py::dict commands;
            for (const CheckReport::Command& one : report.commands) {
              commands[py::str(one.name)] = one.what;
            }
            return commands;
          },
          "Description of each command that can run, by its name.")
      .def_property_readonly(
          "mistakes",
          [](const CheckReport& report) {
            py::list lines;
            for (const InputError& mistake : report.mistakes) lines.append(mistake.what());
            return lines;
          },
          "The first error of every table of the experiment, one line each.")
      .def_readonly("notes", &CheckReport::notes, "Assumptions of the readers, one line each.");
  module.def("check", &check_of, py::arg("experiment"),
             "Reads the experiment and reports its errors and the commands that can run, without "
             "running one.");
}

}  // namespace photorque::python
