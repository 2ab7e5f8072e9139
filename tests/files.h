// Files that tests read, in the temporary folder of their program (tests/main.cpp).
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/files.h"

namespace photorque {

namespace fs = std::filesystem;

inline std::filesystem::path test_file(const std::string& name, const std::string& bytes) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  write_file_whole(path, bytes);
  return path;
}

// With a name that no other has.
inline std::filesystem::path new_file(const std::string& bytes,
                                      const std::string& ending = ".txt") {
  static int next = 0;
  return test_file("file_" + std::to_string(next++) + ending, bytes);
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace photorque
