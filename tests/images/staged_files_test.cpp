// Results replace those of the command's last run, and no other files.
#include "images/writers/staged_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "core/files.h"
#include "core/provenance.h"
#include "tests/images/sample_product.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

class Staged : public FolderTest {
 protected:
  void run(const std::string& command, const std::set<std::string>& files) {
    StagedFiles staged(folder);
    for (const std::string& name : files) write_file_whole(staged.path() / name, command);
    staged.publish_as(command, build_provenance());
  }
  std::set<std::string> there() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
  }
};

TEST_F(Staged, FilesOfTheLastRunDoNotStayBesideNewOnes) {
  run("trace", {"a.csv", "b.csv", "summary.json"});
  write_file_whole(folder / "of_the_user.csv", "mine");
  run("trace", {"b.csv", "summary.json"});
  EXPECT_THAT(there(), testing::UnorderedElementsAre("b.csv", "files.json", "of_the_user.csv",
                                                     "summary.json"));
}

TEST_F(Staged, FilesOfOtherCommandsStay) {
  run("trace", {"a.csv", "shared.csv"});
  run("power", {"iv.csv", "shared.csv"});
  run("trace", {"a.csv"});
  EXPECT_THAT(there(),
              testing::UnorderedElementsAre("a.csv", "files.json", "iv.csv", "shared.csv"));
  EXPECT_EQ(read_file(folder / "shared.csv"), "power");
}

TEST_F(Staged, FilesOfTheUserWithTheNamesOfResultsAreKept) {
  write_file_whole(folder / "recording.csv", "mine");
  run("propagate", {"recording.csv"});
  run("propagate", {"recording.csv"});
  EXPECT_THAT(there(),
              testing::UnorderedElementsAre("files.json", "recording.csv", "recording.csv~"));
  EXPECT_EQ(read_file(folder / "recording.csv~"), "mine");
  EXPECT_EQ(read_file(folder / "recording.csv"), "propagate");
  EXPECT_TRUE(is_result_of(folder, "propagate", "recording.csv"));
  EXPECT_FALSE(is_result_of(folder, "trace", "recording.csv"));
  EXPECT_FALSE(is_result_of(folder, "propagate", "recording.csv~"));
}

TEST_F(Staged, AListOfTheUserIsKept) {
  write_file_whole(folder / "files.json", "[\"mine\"]");
  run("trace", {"a.csv"});
  run("trace", {"a.csv"});
  EXPECT_THAT(there(), testing::UnorderedElementsAre("a.csv", "files.json", "files.json~"));
  EXPECT_EQ(read_file(folder / "files.json~"), "[\"mine\"]");
  EXPECT_TRUE(is_result_of(folder, "trace", "a.csv"));
}

TEST_F(Staged, ListsThatWereTamperedWithReachNoOtherFolder) {
  const fs::path outside = folder.string() + "_outside.csv";
  write_file_whole(outside, "precious");
  write_file_whole(folder / "files.json",
                   R"({"schema": "photorque.files/1", "commands": {"trace": {"files": ["../)" +
                       outside.filename().string() + R"(", 7, "..", ""]}, "x": 3}})");
  run("trace", {"a.csv"});
  EXPECT_EQ(read_file(outside), "precious");
  fs::remove(outside);
}

// Found by reading for it: a list that is nested deeply ended the program by a signal after its
// work.
TEST_F(Staged, ListsNestedDeeplyAreNone) {
  constexpr size_t deep = 300000;
  write_file_whole(folder / "files.json",
                   R"({"schema": "photorque.files/1", "commands": {"trace": )" +
                       std::string(deep, '[') + std::string(deep, ']') + "}}");
  run("trace", {"summary.json"});
  EXPECT_TRUE(there().contains("summary.json"));
}

TEST_F(Staged, UnpublishedFilesAreRemovedWithTheirFolder) {
  {
    const StagedFiles staged(folder / "deep" / "er");
    write_file_whole(staged.path() / "a.csv", "a");
  }
  EXPECT_FALSE(fs::exists(folder / "deep"));
}

}  // namespace
}  // namespace photorque
