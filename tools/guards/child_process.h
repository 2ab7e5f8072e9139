// Another program, run to its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace photorque {

struct ChildResult {
  int status = -1;  // exit status; −1: killed, or stopped after `longest_s`
  double wall_s = 0.0;
  std::string errors;  // what it wrote on standard error, at most 4 kB of it
};

// Runs `program` with `arguments` in the folder `in`; its standard output is thrown away. It is
// stopped after `longest_s`. NumericalError when it cannot be started.
ChildResult run_child(const std::filesystem::path& program,
                      const std::vector<std::string>& arguments, const std::filesystem::path& in,
                      double max_time_s);

// This program's own file.
std::filesystem::path own_program();

}  // namespace photorque
