// Effects that are missing in an experiment, from its recordings.
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
  std::string text;       // of the experiment, with the overrides of the command line
  bool of_light = false;  // recordings are scans, sweeps and runs of light instead of motion

  // Text of diagnosis.json.
  std::string json() const;
  // HTML page of the findings, without a script.
  std::string report() const;
  // Text of the improved experiment for a file in `folder`.
  std::string improved(const std::filesystem::path& folder) const;
};

// Diagnoses recordings of motion, or of light and power, which are recognised by their headers. At
// least one recording is required.
DiagnosisRun run_diagnose(const RunOptions& options,
                          const std::vector<std::filesystem::path>& recordings,
                          const std::vector<std::filesystem::path>& holdouts,
                          const Console& console);

// Writes improved.toml, report.html with the text of `report`, diagnosis.json and, in the
// additional formats, figures (diagnosis_figures()) into a folder.
void write_diagnosis(const DiagnosisRun& run, const std::string& report,
                     const std::filesystem::path& folder, const RunFormats& formats = {});

}  // namespace photorque
