// Properties of an experiment that can be checked without running it.
#pragma once

#include <string>
#include <vector>

#include "core/errors.h"
#include "tools/runs/options.h"

namespace photorque {

struct CheckReport {
  struct Command {
    std::string name;
    std::string what;  // effect of the command, in a sentence
  };
  std::vector<Command> commands;
  std::vector<Command> impossible;  // commands with tables in the file, and why they cannot run
  std::vector<std::string> tables;  // that the file has, in the order of the documents
  // Every key that is unknown, of the wrong type or out of range; beside them, of tables without
  // such, the first that a run would end with.
  std::vector<InputError> mistakes;
  std::vector<std::string> notes;  // assumptions of the readers
};

enum class KeyCheck {
  by_declaration,  // tools/keys first, then the readers
  by_readers,      // the readers alone: for the test that holds them against the declarations
};

// Reads the experiment as every command would: all files that it names, every table, the geometry;
// and sends a few rays, to find lamps inside of solids and maps without light.
CheckReport run_check(const RunOptions& options, KeyCheck keys = KeyCheck::by_declaration);

}  // namespace photorque
