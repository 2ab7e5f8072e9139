// Checks of an experiment that need no run.
#pragma once

#include <string>
#include <vector>

#include "core/errors.h"
#include "tools/runs/options.h"

namespace photorque {

struct CheckReport {
  struct Command {
    std::string name;
    std::string what;  // effect of the command, as a sentence
  };
  std::vector<Command> commands;
  // Commands with tables in the file that cannot run, and the reason.
  std::vector<Command> impossible;
  std::vector<std::string> tables;  // tables of the file, in the order of the documents
  // Every key that is unknown, of the wrong type or out of range. For tables without such keys, the
  // first error with which a run would end.
  std::vector<InputError> mistakes;
  std::vector<std::string> notes;  // assumptions of the readers
};

enum class KeyCheck {
  by_declaration,  // tools/keys first, then the readers
  by_readers,      // only the readers, for the test that compares them with the declarations
};

// Reads the experiment as every command would: all named files, every table, the geometry. Sends a
// few rays to find lamps inside solids and maps without light.
CheckReport run_check(const RunOptions& options, KeyCheck keys = KeyCheck::by_declaration);

// Prints the report as JSON on standard output.
void print_json(const CheckReport& report);

}  // namespace photorque
