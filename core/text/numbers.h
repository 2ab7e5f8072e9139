// Numbers in text files of other programs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace photorque {

// Without blanks, tabs and carriage returns at both ends.
std::string_view trimmed(std::string_view text);

// Lines without their ends (LF, CR LF or CR).
std::vector<std::string_view> lines_of(std::string_view text);

// A whole text as a finite number; a leading plus is accepted. Nothing for anything else.
std::optional<double> number_in(std::string_view text);

// The shortest text that reads back as the same number.
std::string shortest(double value);

}  // namespace photorque
