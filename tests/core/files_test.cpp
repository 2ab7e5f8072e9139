// Files in and out: other objects are rejected, written files appear complete, the files of killed
// processes left is distinguished from the work of living ones.
#include "core/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/errors.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

class FilesInAFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("files_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string refusal(const fs::path& path) {
    return refusal_of([&] { read_file(path); });
  }

  fs::path folder_;
};

TEST_F(FilesInAFolder, DevicesPipesAndFoldersAreRefusedAtOnce) {
  EXPECT_THAT(refusal("/dev/zero"), testing::HasSubstr("found a device, expected a file"));
  EXPECT_THAT(refusal(folder_), testing::HasSubstr("found a folder"));
  EXPECT_THAT(refusal(folder_ / "none"), testing::HasSubstr("found no such file"));
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(refusal(folder_ / "pipe"), testing::HasSubstr("found a pipe"));
}

TEST_F(FilesInAFolder, FilesOfTheKernelAreReadToTheirEnd) {
  EXPECT_THAT(read_file("/proc/self/status"), testing::HasSubstr("VmPeak"));
}

TEST_F(FilesInAFolder, PathsAndLinksOutOfTheFolderAreRefused) {
  write_file_whole(folder_ / "secret", "s");
  write_file_whole(folder_ / "model" / "inside", "i");
  fs::create_symlink(folder_ / "secret", folder_ / "model" / "link");
  fs::create_symlink("inside", folder_ / "model" / "own");
  const auto read = [&](const std::string& name, bool may_leave) {
    return read_file_beside(folder_ / "model", name, 100, may_leave);
  };
  EXPECT_EQ(read("inside", false), "i");
  EXPECT_EQ(read("own", false), "i");
  EXPECT_EQ(read("gone", false), std::nullopt);
  for (const char* way : {"link", "../secret"}) {
    EXPECT_THROW(read(way, false), InputError) << way;
    EXPECT_EQ(read(way, true), "s") << way;
  }
}

// A process that is no more, by its number.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST_F(FilesInAFolder, FilesOfEndedProcessesAreRemovedAndThoseOfRunningOnesStay) {
  const fs::path own = temporary_beside(folder_ / "map.csv");
  std::string name = own.filename().string();
  const std::string mine = std::to_string(::getpid());
  const fs::path dead =
      folder_ / name.replace(name.find(mine), mine.size(), std::to_string(dead_process()));
  for (const fs::path& path : {own, dead, folder_ / ".of_the_user.part"}) std::ofstream(path) << 1;
  remove_leftovers_of_ended_processes(folder_);
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(own));
  remove_leftovers(folder_, ::getpid());
  EXPECT_FALSE(fs::exists(own));
  EXPECT_TRUE(fs::exists(folder_ / ".of_the_user.part"));
}

// A user who may write beside a result cannot place a link where its temporary will be.
TEST_F(FilesInAFolder, TemporariesAreNewAndOfNamesThatCannotBeForeseen) {
  const fs::path file = folder_ / "map.csv";
  EXPECT_NE(temporary_beside(file), temporary_beside(file));
  std::ofstream(folder_ / "victim") << "own";
  write_file_whole(file, [&](const fs::path& temporary) {
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(temporary)));
    std::ofstream(temporary) << "new";
  });
  EXPECT_EQ(read_file(file), "new");
}

TEST_F(FilesInAFolder, FoldersAreMadeWithTheirParentsOrNameTheObstacle) {
  make_folders(folder_ / "a" / "b" / "");
  EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
  make_folders(folder_ / "a");
  write_file_whole(folder_ / "c" / "d.txt", "new");
  EXPECT_EQ(read_file(folder_ / "c" / "d.txt"), "new");
  const std::string refusal =
      refusal_of([&] { make_folders(folder_ / "c" / "d.txt" / "e", "--out"); });
  EXPECT_THAT(refusal, ::testing::HasSubstr("d.txt/e"));
  EXPECT_THAT(refusal, ::testing::HasSubstr("--out"));
}

TEST_F(FilesInAFolder, AFailedWriteLeavesTheOldFileAndNothingElse) {
  write_file_whole(folder_ / "a.txt", "old");
  EXPECT_THROW(write_file_whole(folder_ / "a.txt",
                                [](const fs::path& path) {
                                  std::ofstream(path) << "half";
                                  throw NumericalError("no");
                                }),
               NumericalError);
  EXPECT_EQ(read_file(folder_ / "a.txt"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace photorque
