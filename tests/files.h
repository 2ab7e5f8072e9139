// Files of tests: written into the temporary folder of their program (tests/main.cpp), and read.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

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

inline std::string file_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// The rows of a CSV file without its comments; the first is the header.
inline std::vector<std::vector<std::string>> csv_rows(const fs::path& path) {
  std::istringstream in(file_text(path));
  std::vector<std::vector<std::string>> all;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    all.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) all.back().push_back(cell);
    if (line.back() == ',') all.back().emplace_back();
  }
  return all;
}

inline std::vector<double> last_row(const fs::path& path) {
  const auto rows = csv_rows(path);
  std::vector<double> numbers;
  for (const std::string& cell : rows.back()) numbers.push_back(std::stod(cell));
  return numbers;
}

// The columns of a CSV file by their names, as numbers; an empty cell is no number.
inline std::map<std::string, std::vector<double>> csv_table(const fs::path& path) {
  const auto all = csv_rows(path);
  std::map<std::string, std::vector<double>> table;
  for (size_t r = 1; r < all.size(); ++r) {
    for (size_t c = 0; c < all[r].size(); ++c) {
      const std::string& cell = all[r][c];
      table[all[0][c]].push_back(cell.empty() ? std::nan("") : std::strtod(cell.c_str(), nullptr));
    }
  }
  return table;
}

inline size_t occurrences(const std::string& text, const std::string& of) {
  size_t count = 0;
  for (size_t at = text.find(of); at != std::string::npos; at = text.find(of, at + 1)) ++count;
  return count;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace photorque
