// `diagnose`: recordings against what is believed, and what physics is missing in between.
//
// A straight line: observe → fit the belief → whiten → search (every effect alone, then together)
// → decide → predict what was never fitted → say it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "attitude/propagation/run.h"
#include "attitude/recordings/recording.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

struct NamedRecording {
  std::string name;  // path as given
  Recording recording;
};

struct DiagnoseOptions {
  int threads = 0;              // 0: all
  int most_effects = 3;         // that may be found together
  size_t most_blocks = 6000;    // into which each recording is averaged
  double holdout_share = 0.25;  // of each recording, its end, kept back when there is no holdout
  // Called with what begins; may be empty.
  std::function<void(const std::string&)> progress;
};

// InputError for recordings that hold no attitude or hardly any. The same result for any number of
// threads.
Diagnosis diagnose(const BelievedModel& believed, const std::vector<NamedRecording>& recordings,
                   const std::vector<NamedRecording>& holdouts,
                   const DiagnoseOptions& options = {});

}  // namespace photorque
