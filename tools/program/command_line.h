// The command line, read by CLI11, and its texts for other programs: help, manual page and
// completions for shells.
#pragma once

#include <optional>
#include <vector>

#include "tools/verbs/verb.h"

namespace photorque {

struct CommandLine {
  // Of a line that is answered already: help, version, manual, or one line on standard error.
  std::optional<int> status;
  const Verb* verb = nullptr;
  Command command = {};  // of the verb, its options read
};

CommandLine read_command_line(int argc, char** argv, const std::vector<Verb>& verbs);

}  // namespace photorque
