// diagnose(): effects that are missing in an experiment according to its recordings.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/files.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/pages.h"
#include "python/bindings/results.h"
#include "tools/pages/pages.h"
#include "tools/verbs/attitude/diagnose.h"

namespace photorque::python {
namespace {

struct DiagnosisHandle : DiagnosisRun {
  RunOptions options;
};

using Paths = std::vector<std::filesystem::path>;

DiagnosisHandle diagnose_recordings(const ExperimentHandle& experiment, const Paths& recordings,
                                    const Paths& holdouts, int threads, const py::object& log) {
  const RunOptions options = experiment.with(threads, py::none());
  const Call call(options.experiment, py::none(), log);
  return call.run([&] {
    return DiagnosisHandle{run_diagnose(options, recordings, holdouts, call.console()), options};
  });
}

py::dict parameters_of(const FoundEffect& effect) {
  py::dict all;
  for (const FittedParameter& parameter : effect.parameters) {
    py::dict one;
    one["value"] = copy_of(parameter.value);
    one["standard_error"] = copy_of(parameter.sigma);
    all[py::str(parameter.key)] = one;
  }
  return all;
}

void bind_effect(py::module_& module) {
  py::class_<FoundEffect>(module, "Effect", "An effect that the experiment lacks.")
      .def_readonly("kind", &FoundEffect::kind, "Kind of the effect, such as \"magnetic_dipole\".")
      .def_readonly("probability", &FoundEffect::probability, "Probability of the effect, 0 to 1.")
      .def_readonly("explanation", &FoundEffect::explanation, "One sentence of physics.")
      .def_readonly("indistinguishable_from", &FoundEffect::indistinguishable_from,
                    "Kinds that explain the recordings equally well.")
      .def_property_readonly("parameters", &parameters_of,
                             "By key, in its unit: {\"value\": array, \"standard_error\": array}.");
}

}  // namespace

void bind_diagnosis(py::module_& module) {
  bind_effect(module);
  const auto of = [](auto Diagnosis::*member) {
    return [member](const DiagnosisHandle& run) { return run.diagnosis.*member; };
  };
  py::class_<DiagnosisHandle>(module, "Diagnosis",
                              "The missing effects of the experiment, and their probability.")
      .def_property_readonly(
          "verdict", [](const DiagnosisHandle& run) { return name_of(run.diagnosis.verdict); },
          "\"consistent\", \"missing_physics\" or \"unexplained\".")
      .def_property_readonly("confidence", of(&Diagnosis::confidence),
                             "Probability that the verdict is correct, 0 to 1.")
      .def_property_readonly("sentence", of(&Diagnosis::sentence),
                             "The result in one or two sentences.")
      .def_property_readonly("effects", of(&Diagnosis::effects),
                             "List of Effect that passed all tests.")
      .def_property_readonly("warnings", of(&Diagnosis::warnings),
                             "Notes on the recordings and on the fit, one line each.")
      .def_property_readonly(
          "chi2_per_sample_before", of(&Diagnosis::chi2_per_sample_before),
          "χ² per sample of the fitted data for the nominal model; 1: noise only.")
      .def_property_readonly("chi2_per_sample_after", of(&Diagnosis::chi2_per_sample_after),
                             "χ² per sample of the fitted data with the effects.")
      .def_property_readonly(
          "provenance", [](const DiagnosisHandle& run) { return provenance_of(run.provenance); },
          "Version, git hash, seed and the hashes of all inputs.")
      .def_property_readonly("json", &DiagnosisHandle::json, "The content of diagnosis.json.")
      .def(
          "improved",
          [](const DiagnosisHandle& run, const std::filesystem::path& folder) {
            return run.improved(folder);
          },
          py::arg("folder") = ".", "The improved experiment as TOML text.")
      .def_property_readonly(
          "report_html", [](const DiagnosisHandle& run) { return run.report(); },
          "HTML text of the report with charts, without script.")
      .def(
          "write_page",
          [](const DiagnosisHandle& run, const std::filesystem::path& path) {
            const py::gil_scoped_release release;
            write_file_whole(
                path, interactive_report_html(run.diagnosis, run.provenance, run.of_light,
                                              run.options, head_of(run.options, "diagnose")));
            return path.string();
          },
          py::arg("path"),
          "Writes the interactive report (measured and simulated platform) as one HTML page; "
          "returns its path.")
      .def(
          "write",
          [](const DiagnosisHandle& run, const std::filesystem::path& folder) {
            const py::gil_scoped_release release;
            write_diagnosis(run, run.report(), folder);
          },
          py::arg("folder"), "Writes diagnosis.json, improved.toml and report.html.");
  module.def("diagnose", &diagnose_recordings, py::arg("experiment"), py::arg("recordings"),
             py::kw_only(), py::arg("holdouts") = Paths{}, py::arg("threads") = 0,
             py::arg("log") = py::none(),
             "Physical effects that an experiment lacks, from recordings (CSV files of "
             "motion, or of light and power).");
}

}  // namespace photorque::python
