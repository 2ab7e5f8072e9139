#include "python/bindings/experiment.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/errors.h"
#include "python/bindings/document.h"
#include "scenes/experiment/document.h"
#include "scenes/experiment/toml.h"

namespace photorque::python {
namespace {

// The tree of the text with all changes; InputError where the text is no TOML or a change makes no
// sense.
SettingsNode tree_of(const RunOptions& options) {
  SettingsNode root = parse_toml(*options.text, options.experiment.string());
  for (const std::string& one : options.overrides) apply_override(root, one);
  return root;
}

ExperimentHandle changed(ExperimentHandle experiment, const py::dict& keys) {
  for (const auto& [key, value] : keys) {
    const auto name = key.cast<std::string>();
    experiment.options.overrides.push_back(name + "=" + toml_value(settings_of(value, name)));
  }
  tree_of(experiment.options);
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
    options.experiment = source.cast<std::filesystem::path>();
    options.text = options.experiment_text();
  }
  return changed(std::move(experiment), keys);
}

}  // namespace

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
           "The same with other values: {\"attitude.tilt_deg\": 30, \"source[0].power_W\": 10}, as "
           "the program's --set.")
      .def_property_readonly(
          "path", [](const ExperimentHandle& self) { return self.options.experiment.string(); },
          "Its file, or what errors call the dict.")
      .def_property_readonly(
          "text", [](const ExperimentHandle& self) { return *self.options.text; },
          "TOML as written, without the changes of keys.")
      .def_property_readonly(
          "changes", [](const ExperimentHandle& self) { return self.options.overrides; },
          "KEY=VALUE of every change, in order.")
      .def(
          "to_dict", [](const ExperimentHandle& self) { return value_of(tree_of(self.options)); },
          "All keys as written, with the changes.")
      .def("__repr__", [](const ExperimentHandle& self) {
        return "Experiment(\"" + self.options.experiment.string() + "\"" +
               (self.options.overrides.empty()
                    ? ")"
                    : ", " + std::to_string(self.options.overrides.size()) + " keys changed)");
      });
}

}  // namespace photorque::python
