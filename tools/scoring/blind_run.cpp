#include "tools/scoring/blind_run.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "core/files.h"
#include "tools/guards/child_process.h"
#include "tools/scoring/case_files.h"
#include "tools/scoring/replay.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// Propagates the answer and compares with the recording; what a user would do first.
nlohmann::json replayed(const fs::path& blind, const RecordedCase& made, double max_processor_s) {
  nlohmann::json replay = nlohmann::json::object();
  if (!fs::exists(blind / "diagnosis" / "improved.toml")) return replay;
  // Without the camera's own noise, which would be added to that of the recording, and so closely
  // that the rate is as good as constant between two rows.
  constexpr double closer = 10.0;
  const ChildResult result =
      run_child(own_program(),
                {"propagate", "diagnosis/improved.toml", "--out", "replay", "--quiet", "--threads",
                 "1", "--set", "sensors.camera.noise_arcsec=[0, 0, 0]", "--set",
                 "propagate.output_rate_Hz=" + std::to_string(closer * made.rate_Hz)},
                blind, max_processor_s);
  replay["replay_status"] = result.status;
  if (result.status == 0) {
    const std::array<double, 3> noise_arcsec =
        found_noise_arcsec(nlohmann::json::parse(read_file(blind / "diagnosis" / "diagnosis.json")),
                           made.camera_noise_arcsec);
    replay["replay_chi2"] =
        replayed_chi2(blind / "run1.csv.gz", blind / "replay" / "recording.csv", noise_arcsec);
  } else {
    write_file_whole(blind / "diagnosis" / "replay_error.txt", result.errors);
  }
  fs::remove_all(blind / "replay");
  return replay;
}

}  // namespace

void diagnose_blind(const fs::path& case_folder, const std::string& experiment,
                    const fs::path& blind, const BlindRun& how) {
  const fs::path out = blind / "diagnosis", stamp = blind / "done.txt";
  if (fs::exists(stamp) && read_file(stamp) == how.program_hash) return;
  fs::remove_all(blind);
  make_folders(out);
  write_file_whole(blind / "experiment.toml", read_file(case_folder / experiment));
  const CaseFiles files = files_of_case(case_folder);
  std::vector<std::string> words = {"diagnose", "experiment.toml"}, names;
  for (const std::string& name : files.recordings) {
    words.insert(words.end(), {"--recording", name});
    names.push_back(name);
  }
  for (const std::string& name : files.holdouts) {
    words.insert(words.end(), {"--holdout", name});
    names.push_back(name);
  }
  words.insert(words.end(),
               {"--out", "diagnosis", "--quiet", "--threads", std::to_string(how.threads)});
  if (fs::exists(case_folder / "scene.gltf")) names.emplace_back("scene.gltf");
  for (const std::string& name : names) {
    write_file_whole(blind / name, read_file(case_folder / name));
  }
  const ChildResult result = run_child(own_program(), words, blind, how.max_processor_s);
  make_folders(out);
  nlohmann::json runs = {{"processor_s", result.processor_s}, {"exit_status", result.status}};
  if (how.replay && result.status == 0 && !files.of_light) {
    runs.update(replayed(blind, recorded_case(case_folder), how.max_processor_s));
  }
  write_file_whole(out / "runs.json", runs.dump(1) + "\n");
  if (result.status != 0 || !result.errors.empty()) {
    write_file_whole(out / "error.txt",
                     "exit " + std::to_string(result.status) + ": " + result.errors);
  }
  for (const std::string& name : names) fs::remove(blind / name);
  write_file_whole(stamp, how.program_hash);
}

}  // namespace photorque
