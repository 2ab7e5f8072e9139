// Where the numbers that the tests compare with lie.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace photorque::outside {

// References that come with the sources: a file or folder of tests/data, whose README.md says who
// made it and how.
inline std::filesystem::path reference_data(const std::string& name) {
  return std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "tests" / "data" / name;
}

// Files of third parties, which we may not pass on: they are read in place from a folder `shared`
// beside the source tree, and are absent elsewhere.
inline std::filesystem::path third_party(const std::string& name) {
  return std::filesystem::path(PHOTORQUE_SOURCE_DIR).parent_path() / "shared" / name;
}

// The values of a file of raw 32-bit floats, little-endian; a test fails where it cannot be read.
inline std::vector<double> read_float32(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  std::vector<double> values;
  for (float value; in.read(reinterpret_cast<char*>(&value), sizeof value);)
    values.push_back(value);
  return values;
}

}  // namespace photorque::outside

// Ends the test as skipped where a file of third parties is absent. tools/check lists the reasons,
// so that they name the file.
#define PHOTORQUE_NEEDS_THIRD_PARTY(name)                                \
  if (!std::filesystem::exists(::photorque::outside::third_party(name))) \
  GTEST_SKIP() << "without ../shared/" << name
