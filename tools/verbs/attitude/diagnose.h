// The missing effects between an experiment and its recordings.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/provenance.h"
#include "diagnosis/diagnosis.h"
#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

struct DiagnosisRun {
  Diagnosis diagnosis;
  Provenance provenance;
  std::filesystem::path experiment;
  std::string text;       // of the experiment, with the changes of the command line
  bool of_light = false;  // of scans, sweeps and runs instead of motion

  std::string json() const;
  // The page of the findings, which needs no script.
  std::string report() const;
  // The improved experiment, as it would stand in a folder.
  std::string improved(const std::filesystem::path& folder) const;
};

// Recordings of motion, or of light and power: recognised by their headers. At least one.
DiagnosisRun run_diagnose(const RunOptions& options,
                          const std::vector<std::filesystem::path>& recordings,
                          const std::vector<std::filesystem::path>& holdouts,
                          const Console& console);

// The text of a first experiment for recordings without one (guess_experiment()), to be written to
// `file`. Throws InputError if `diagnose` could not read it.
std::string first_experiment(const std::vector<std::filesystem::path>& recordings,
                             const std::filesystem::path& file, const RecordingOptions& reading);

// improved.toml, report.html with the text of `report`, diagnosis.json and, in the further formats,
// figures (diagnosis_figures()) into a folder.
void write_diagnosis(const DiagnosisRun& run, const std::string& report,
                     const std::filesystem::path& folder, const RunFormats& formats = {});

}  // namespace photorque
