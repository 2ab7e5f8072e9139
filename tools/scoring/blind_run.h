// One case diagnosed by the program itself, in a folder that holds nothing but what a user would
// have.
#pragma once

#include <filesystem>
#include <string>

namespace photorque {

struct BlindRun {
  std::string program_hash;        // what has been diagnosed by this very program is not done again
  bool replay = true;              // also propagate the improved experiment
  double max_processor_s = 900.0;  // for the diagnosis, and for the propagation
  int threads = 1;                 // of the diagnosis
};

// Diagnoses `experiment` (a file of the case) in the folder `blind`, and leaves there what was
// answered (diagnosis/), how long it took and how it ended (diagnosis/runs.json, error.txt) and how
// well the improved experiment repeats the recording.
void diagnose_blind(const std::filesystem::path& case_folder, const std::string& experiment,
                    const std::filesystem::path& blind, const BlindRun& how);

}  // namespace photorque
