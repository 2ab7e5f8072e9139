// Sentences with numbers in them.
#pragma once

#include <cstdio>
#include <string>

namespace photorque {

// As printf; at most 499 characters.
template <typename... Values>
std::string written(const char* format, Values... values) {
  char text[500];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace photorque
