// Everything about an experiment that can be known without running it.
#pragma once

#include <string>
#include <vector>

#include "core/errors.h"
#include "tools/runs/options.h"

namespace photorque {

struct CheckReport {
  struct Command {
    std::string name;
    std::string
        what;  // what the command would do, in a sentence; empty: the file has nothing for it
  };
  std::vector<Command> commands;     // in the order of the program's
  std::vector<InputError> mistakes;  // as runs would end with: the first of every table
  std::vector<std::string> notes;    // what the readers had to assume
};

// Reads the experiment as every command would: all files that it names, every table, the geometry;
// and sends a few rays, to find lamps inside of solids and maps without light.
CheckReport check_experiment(const RunOptions& options);

}  // namespace photorque
