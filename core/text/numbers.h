// Numbers in text, the same in every locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/errors.h"

namespace photorque {

// A whole text as a finite number; a leading plus is accepted. Nothing for anything else, blanks
// included.
std::optional<double> number_in(std::string_view text);

// The same where nothing else will do: InputError at `where` under the key `what`.
double require_number(std::string_view text, const InputLocation& where, const std::string& what,
                      const std::string& expected = "a number");

// A number that counts something, as what it counts; InputError unless whole and in [low, high].
size_t require_count(double value, const InputLocation& where, const std::string& what, int low,
                     int high);

// The shortest text that reads back as the same number.
std::string shortest(double value);

}  // namespace photorque
