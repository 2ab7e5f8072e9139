// Folders of cases: an experiment, recordings, and the truth of what was injected (truth.json).
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace photorque {

// What was recorded and what is held out: as the truth lists them, of motion run1 and run2.
struct CaseFiles {
  std::vector<std::string> recordings = {"run1.csv.gz"}, holdouts = {"run2.csv.gz"};
  bool of_light = false;
};
CaseFiles files_of_case(const std::filesystem::path& case_folder);

// Whether a folder holds a truth.
bool is_case(const std::filesystem::path& folder);

// The cases in a folder, by name. InputError where there is none, or a file of one is missing.
std::vector<std::filesystem::path> cases_in(const std::filesystem::path& folder);

// What prove notes of a case beside its truth; of cases made elsewhere, what most of them have.
struct RecordedCase {
  std::array<double, 3> camera_noise_arcsec = {37.0, 37.0, 12.0};  // as the experiment states it
  double rate_Hz = 20.0;
};
// InputError where either is no number.
RecordedCase recorded_case(const std::filesystem::path& case_folder);

}  // namespace photorque
