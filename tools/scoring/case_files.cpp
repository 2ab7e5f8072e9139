#include "tools/scoring/case_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

}  // namespace

bool is_case(const fs::path& folder) {
  return fs::exists(folder / "truth.json");
}

CaseFiles files_of_case(const fs::path& case_folder) {
  const auto truth = nlohmann::json::parse(read_file(case_folder / "truth.json"), nullptr, false);
  CaseFiles files;
  const auto list = [&](const char* key, std::vector<std::string>& names) {
    if (!truth.is_object() || !truth.contains(key) || !truth[key].is_array()) return;
    files.of_light = true;
    names.clear();
    for (const auto& name : truth[key]) {
      if (name.is_string()) names.push_back(fs::path(name.get<std::string>()).filename().string());
    }
  };
  list("recordings", files.recordings);
  list("holdouts", files.holdouts);
  return files;
}

std::vector<fs::path> cases_in(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder, missing)) {
    if (entry.is_directory() && is_case(entry.path())) folders.push_back(entry.path());
  }
  if (folders.empty()) {
    throw InputError({}, "--cases", "no case in " + folder.string(),
                     "folders with experiment.toml, recordings and truth.json");
  }
  for (const fs::path& each : folders) {
    const CaseFiles files = files_of_case(each);
    std::vector<std::string> names = {"experiment.toml"};
    names.insert(names.end(), files.recordings.begin(), files.recordings.end());
    names.insert(names.end(), files.holdouts.begin(), files.holdouts.end());
    for (const std::string& file : names) {
      if (!fs::is_regular_file(each / file)) {
        throw InputError({(each / file).string()}, "--cases", "no such file", "a complete case");
      }
    }
  }
  std::ranges::sort(folders);
  return folders;
}

RecordedCase recorded_case(const fs::path& case_folder) {
  const fs::path file = case_folder / "truth.json";
  const auto truth = nlohmann::json::parse(read_file(file), nullptr, false);
  RecordedCase made;
  if (!truth.is_object()) return made;
  try {
    made.camera_noise_arcsec = truth.value("camera_noise_arcsec", made.camera_noise_arcsec);
  } catch (const nlohmann::json::exception&) {
    throw InputError({file.string()}, "camera_noise_arcsec", "something else", "three numbers");
  }
  try {
    made.rate_Hz = truth.value("rate_Hz", made.rate_Hz);
  } catch (const nlohmann::json::exception&) {
    throw InputError({file.string()}, "rate_Hz", "something else", "a number");
  }
  return made;
}

}  // namespace photorque
