// `diagnose`: compares recordings with the nominal model and finds missing physics.
//
// The steps are: observe → fit the nominal model → whiten → search (every effect alone, then
// together) → decide → predict the held-out data → report.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "attitude/propagation/run.h"
#include "attitude/recordings/recording.h"
#include "diagnosis/diagnosis.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

struct NamedRecording {
  std::string name;  // path as given
  Recording recording;
};

struct DiagnoseOptions {
  int threads = 0;                       // 0: all
  size_t max_blocks = 6000;              // per recording after averaging
  Thresholds limits;                     // limits of search and decision
  std::set<std::string> read_elsewhere;  // columns used by other readers
  // Called with the name of each step as it starts; may be empty.
  std::function<void(const std::string&)> progress;
};

// Throws InputError for recordings with no or hardly any attitude data. The result is independent
// of the number of threads.
Diagnosis diagnose(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                   const std::vector<NamedRecording>& holdouts,
                   const DiagnoseOptions& options = {});

}  // namespace photorque
