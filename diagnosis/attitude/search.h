// The search for what is missing: every candidate alone, then the best with every other.
#pragma once

#include "diagnosis/attitude/trial.h"

namespace photorque {

struct SearchOptions {
  int threads = 0;      // 0: all
  int max_effects = 3;  // together
};

// All trials that were fitted, the nominal model first.
std::vector<Trial> search(const Fit& nominal, const Candidates& all,
                          const std::vector<Observation>& runs, const SearchOptions& options = {});

}  // namespace photorque
