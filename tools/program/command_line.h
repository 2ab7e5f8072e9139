// The command line, parsed with CLI11, and its texts for other programs: help, manual page and
// shell completions.
#pragma once

#include <optional>
#include <vector>

#include "tools/verbs/verb.h"

namespace photorque {

struct CommandLine {
  // Exit status if no run is needed: help, version, manual, or an error. Empty otherwise.
  std::optional<int> status;
  const Verb* verb = nullptr;
  Command command = {};  // of the verb, with parsed options
};

// Parses the command line, and prints help, manual or the error of a wrong line.
CommandLine read_command_line(int argc, char** argv, const std::vector<Verb>& verbs);

}  // namespace photorque
