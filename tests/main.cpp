// Runs the tests of one program with a separate temporary folder, because CTest runs every test as
// a process and several at once: two tests that write the same file name never meet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

namespace {

// Made when the program starts, removed with all that the tests left in it when it ends.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "photorque_test_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      std::cerr << name << ": cannot make a temporary folder\n";
      std::exit(EXIT_FAILURE);
    }
    path_ = name;
    setenv("TMPDIR", name.c_str(), 1);               // std::filesystem::temp_directory_path
    setenv("TEST_TMPDIR", (name + "/").c_str(), 1);  // testing::TempDir
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

 private:
  std::filesystem::path path_;
};

}  // namespace

int main(int argc, char** argv) {
  const TemporaryFolder folder;
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
