// Numbers in text.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace photorque::injected {

template <class... Numbers>
std::string printed(const char* format, Numbers... numbers) {
  char text[512];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

template <class List>
std::string printed_list(const char* format, const List& numbers) {
  std::string text;
  for (const double x : numbers) text += (text.empty() ? "" : ", ") + printed(format, x);
  return "[" + text + "]";
}

}  // namespace photorque::injected
