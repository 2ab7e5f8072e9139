// Another program, run to its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace photorque {

struct ChildResult {
  int status = -1;           // exit status; −1: killed, or stopped
  double processor_s = 0.0;  // of all its threads, user and system
  std::string errors;        // what it wrote on standard error, at most 4 kB of it
};

// Runs `program` with `arguments` in the folder `in`; its standard output is thrown away. It is
// stopped when it has used `max_processor_s`, or after thirty times as long whatever it does.
// NumericalError when it cannot be started.
ChildResult run_child(const std::filesystem::path& program,
                      const std::vector<std::string>& arguments, const std::filesystem::path& in,
                      double max_processor_s);

// This program's own file.
std::filesystem::path own_program();

}  // namespace photorque
