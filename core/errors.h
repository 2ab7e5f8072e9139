// The only two exceptions that leave library code.
#pragma once

#include <stdexcept>
#include <string>

namespace photorque {

// Source of a value that the user wrote. `line` counts from 1; it is 0 for sources without lines
// (binary files, the command line).
struct InputLocation {
  std::string file;
  int line = 0;
};

// The input is wrong and the user can repair it. what() is one line:
//   experiment.toml:12: source[0].power_W: found -3, expected a number > 0
class InputError : public std::runtime_error {
 public:
  InputError(const InputLocation& where, const std::string& key, const std::string& found,
             const std::string& expected);

  // Whether what() begins with the name of a file.
  bool names_file() const { return names_file_; }

 private:
  bool names_file_;
};

// The input is legal and the computation failed (no convergence, loss of precision).
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace photorque
