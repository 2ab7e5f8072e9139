// The command line, read by CLI11, and its texts for other programs: help, manual page and
// completions for shells.
#pragma once

#include <optional>
#include <vector>

#include "tools/verbs/verb.h"

namespace photorque {

struct CommandLine {
  // Exit status of a command line that needs no run: help, version, manual, or an error.
  std::optional<int> status;
  const Verb* verb = nullptr;
  Command command = {};  // of the verb, its options read
};

CommandLine read_command_line(int argc, char** argv, const std::vector<Verb>& verbs);

}  // namespace photorque
