// The pages of the commands: what each of them found, with its stage.
#pragma once

#include <string>

#include "tools/pages/result.h"

namespace photorque {

// What a page says of the run beside its results.
struct PageHead {
  std::string title;  // the experiment's name
  std::string verb;
  std::string command;  // that makes it again
};

// The page of a run of that verb, trace or power.
RunFile light_page(const OpticalRun& run, const OpticalResult& light, const RunResult& result,
                   const PageHead& head);

}  // namespace photorque
