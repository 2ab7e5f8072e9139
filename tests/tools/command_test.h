// Shared by the tests of the commands: the program run as a user runs it, in a separate folder.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace photorque {

// The exit status and all that the program printed.
struct Outcome {
  int status = -1;
  std::string out, err;
};

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class CommandTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }

  // `photorque ARGUMENTS`.
  Outcome run(const std::string& arguments) const {
    const std::string command = std::string(PHOTORQUE_BINARY_DIR) + "/photorque " + arguments +
                                " >" + at("stdout") + " 2>" + at("stderr");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_text(at("stdout")),
            file_text(at("stderr"))};
  }
  // One that succeeds.
  Outcome succeed(const std::string& arguments) const {
    Outcome got = run(arguments);
    EXPECT_EQ(got.status, 0) << arguments << '\n' << got.err;
    return got;
  }
  // The lines, usually one, of one that is refused.
  std::string refused(const std::string& arguments, int lines = 1) const {
    const Outcome got = run(arguments);
    EXPECT_EQ(got.status, 2) << arguments << '\n' << got.err;
    EXPECT_EQ(std::ranges::count(got.err, '\n'), lines) << arguments << '\n' << got.err;
    return got.err;
  }
  // The path of a file in the test's folder.
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  // Writes a file into the test's folder and gives its path.
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(at(name)) << text;
    return at(name);
  }
  // Every file below a folder by its name.
  std::map<std::string, std::string> files(const std::string& name) const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / name)) {
      if (entry.is_regular_file()) all[entry.path().filename()] = file_text(entry.path());
    }
    return all;
  }

  std::filesystem::path folder_;
};

}  // namespace photorque
