// What one run of a command gave, as a sweep keeps it.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"

namespace photorque {

// "KEY=VALUE" of every key that a run changes.
using Changes = std::vector<std::string>;

struct RunOutcome {
  std::vector<Quantity> figures;  // of its summary; none when it failed
  int status = 0;                 // as the program's exit status: 2 wrong input, 3 numerical
  std::string error = {};         // one line
  bool failed() const { return status != 0; }
};

}  // namespace photorque
