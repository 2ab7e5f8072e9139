// Where a run writes: found wanting before the work, kept by one run at a time, left clean.
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "core/files.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

const std::string quick = " --set trace.rays=16384", endless = " --set trace.rays=3e10";

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class OutputFolders : public CommandTest {
 protected:
  static pid_t start_trace(const std::string& arguments) {
    return start("trace " + nominal_file + arguments);
  }
  static void wait_until(const std::function<bool()>& there) {
    for (const auto begin = Clock::now(); !there() && seconds_since(begin) < 20.0;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  std::vector<std::string> hidden(const std::string& name) const {
    std::vector<std::string> all;
    std::error_code gone;
    for (const auto& entry : fs::recursive_directory_iterator(at(name), gone)) {
      const std::string file = entry.path().filename().string();
      if (file.starts_with('.')) all.push_back(file);
    }
    return all;
  }
};

// It took 16 s of work before.
TEST_F(OutputFolders, ThatAreFilesAreFoundBeforeTheWork) {
  write("taken", "mine");
  const auto begin = Clock::now();
  for (const std::string out : {"taken", "taken/below"}) {
    EXPECT_THAT(refused("trace " + nominal_file + endless + " --out " + at(out)),
                HasSubstr("--out: found"));
  }
  EXPECT_LT(seconds_since(begin), 10.0);
  EXPECT_EQ(file_text(at("taken")), "mine");
}

// An improved.toml that is diagnosed again into its own folder, say.
TEST_F(OutputFolders, ResultsThatReplaceTheInputAreRejectedBeforeTheRun) {
  const std::string text = file_text(nominal_file);
  fs::create_directories(at("o"));
  write("o/again.toml", text);
  write("o/files.json", R"({"schema": "photorque.files/1",
                            "commands": {"trace": {"files": ["again.toml"]}}})");
  EXPECT_THAT(refused("trace " + at("o/again.toml") + endless + " --out " + at("o")),
              HasSubstr("whose again.toml the run would replace"));
  EXPECT_EQ(file_text(at("o/again.toml")), text);
}

TEST_F(OutputFolders, AWorkingFolderThatWasRemovedIsNamed) {
  const std::string gone = at("gone");
  fs::create_directories(gone);
  const int status = std::system(
      ("cd " + gone + " && rmdir " + gone + " && " + program_file + " check x.toml 2>" + at("err"))
          .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_EQ(
      file_text(at("err")),
      "photorque: found a working directory that was removed, expected an existing one (cd)\n");
}

TEST_F(OutputFolders, AFullStandardOutputIsNamed) {
  const int status = std::system(
      (program_file + " schema --key " + "trace.rays >/dev/full 2>" + at("err")).c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_EQ(
      file_text(at("err")),
      "standard output: found a write that failed, expected space, permission and a reader\n");
}

TEST_F(OutputFolders, ThatCannotBeWrittenAreFoundBeforeTheWork) {
  fs::create_directory_symlink("loop", at("loop"));
  EXPECT_THAT(refused("trace " + nominal_file + endless + " --out " + at("loop")),
              HasSubstr("expected a folder that can be made"));
  fs::create_directories(at("locked"));
  fs::permissions(at("locked"), fs::perms::owner_read | fs::perms::owner_exec);
  if (::access(at("locked").c_str(), W_OK) == 0) GTEST_SKIP() << "the superuser may write anywhere";
  EXPECT_THAT(refused("trace " + nominal_file + endless + " --out " + at("locked")),
              HasSubstr("a folder that is not writable"));
}

TEST_F(OutputFolders, AreNotLeftBehindByRunsThatAreRefused) {
  for (const char* out : {"a/b/c", "a/./b/.", "a/b/../b/"}) {
    EXPECT_EQ(run("trace " + at("none.toml") + " --out " + at(out)).status, 2);
    EXPECT_FALSE(fs::exists(at("a"))) << out;
  }
  // The default folder is out/EXPERIMENT/trace.
  const std::string inside = "/photorque trace . 2>" + at("said");
  EXPECT_NE(std::system(("cd " + at("") + " && " + PHOTORQUE_BINARY_DIR + inside).c_str()), 0);
  EXPECT_FALSE(fs::exists(at("out")));
}

// As the superuser, who may write anywhere, too.
TEST_F(OutputFolders, OfTheSystemAreRefused) {
  fs::create_directory_symlink("/etc", at("link"));
  for (const std::string& out :
       {std::string("/"), std::string("//"), std::string("/usr/bin"), std::string("/usr/bin/../.."),
        std::string("/dev"), std::string("/tmp"), std::string("/usr/lib32/photorque"),
        std::string("/usr/local/bin"), std::string("/var/log/photorque"),
        std::string("/var/lib/photorque"), std::string("/run/photorque"), at("link"),
        at("link") + "/photorque"}) {
    EXPECT_THAT(refused("trace " + nominal_file + endless + " --out " + out),
                HasSubstr("--out: found a folder of the system"))
        << out;
  }
}

// In these trees every user may have folders.
TEST_F(OutputFolders, OfAllUsersMayContainResults) {
  for (const std::string tree : {"/var/tmp", "/dev/shm"}) {
    const fs::path out = fs::path(tree) / ("photorque_test_" + std::to_string(::getpid()));
    if (::access(tree.c_str(), W_OK) != 0) continue;
    succeed("trace " + nominal_file + quick + " --out " + out.string());
    fs::remove_all(out);
  }
}

// Only the superuser can give a folder away. A list of files in it proves nothing.
TEST_F(OutputFolders, OfOtherUsersAreRefused) {
  fs::create_directories(at("theirs"));
  write("theirs/files.json", "{}");
  if (::chown(at("theirs").c_str(), 12345, 12345) != 0) GTEST_SKIP() << "no right to give away";
  EXPECT_THAT(refused("trace " + nominal_file + endless + " --out " + at("theirs")),
              HasSubstr("--out: found a folder of user 12345"));
  EXPECT_EQ(std::distance(fs::directory_iterator(at("theirs")), fs::directory_iterator()), 1);
}

TEST_F(OutputFolders, BelongToOneRunAtATime) {
  const pid_t first = start_trace(endless + " --out " + at("o"));
  wait_until([&] { return fs::exists(at("o")); });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const Outcome second = run("trace " + nominal_file + quick + " --out " + at("o"));
  kill_process(first);
  EXPECT_THAT(refusal_in(second), HasSubstr("a folder that another run is writing into"));
  // A killed run holds no lock.
  succeed("trace " + nominal_file + quick + " --out " + at("o"));
}

TEST_F(OutputFolders, AreLeftCleanBySignalsWithinASecond) {
  int after_ms = 20;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU}) {
    const pid_t child = start_trace(quick + " --out " + at("o/p"));
    std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
    const auto begin = Clock::now();
    ::kill(child, signal);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_LT(seconds_since(begin), 1.0);
    wait_until([&] { return hidden("o").empty(); });
    EXPECT_THAT(hidden("o"), testing::IsEmpty()) << after_ms;
    EXPECT_LT(seconds_since(begin), 2.0);
    const bool ended = WIFSIGNALED(status) && WTERMSIG(status) == signal;
    EXPECT_TRUE(ended || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) << status;
    fs::remove_all(at("o"));
    after_ms += 50;
  }
}

// A reader as `head` does not end the run, so that its results are complete.
TEST_F(OutputFolders, HoldAllResultsWhenTheReaderOfTheTextLeaves) {
  const std::string command = "{ " + program_file + " trace " + nominal_file +
                              " --set trace.rays=4096 --out " + at("o") + " 2>" + at("err") +
                              "; echo $? >" + at("status") + "; } | true";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(file_text(at("status")), "2\n");
  EXPECT_THAT(file_text(at("err")), HasSubstr("a reader"));
  EXPECT_TRUE(fs::exists(at("o/summary.json")));
  EXPECT_THAT(hidden("o"), testing::IsEmpty());
}

// The process that cleans up after a stopped run held its lock a moment longer than the run lived
// (found by tools/faults on fit-cell).
TEST_F(OutputFolders, AreFreeAsSoonAsARunWasStopped) {
  for (int i = 0; i < 4; ++i) {
    const pid_t child = start_trace(endless + " --out " + at("o"));
    wait_until([&] { return fs::exists(at("o")); });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    ::kill(child, SIGINT);
    end_of(child);
    succeed("trace " + nominal_file + " --set trace.rays=4096 --out " + at("o"));
  }
}

TEST_F(OutputFolders, AreClearedOfFilesOfKilledRuns) {
  const pid_t child = start_trace(endless + " --out " + at("o"));
  kill_process(child);
  std::string name = temporary_beside(fs::path(at("o")) / "results").filename().string();
  const std::string own = std::to_string(::getpid());
  name.replace(name.find(own), own.size(), std::to_string(child));
  fs::create_directories(fs::path(at("o")) / name);
  succeed("trace " + nominal_file + quick + " --out " + at("o"));
  EXPECT_THAT(hidden("o"), testing::IsEmpty());
}

// Latin-1, say. What is written names the file as far as UTF-8 can.
TEST_F(OutputFolders, AndExperimentsMayHaveNamesThatAreNotUtf8) {
  const fs::path scenes = fs::path(nominal_file).parent_path();
  fs::copy(scenes / "stasis.gltf", at("stasis.gltf"));
  write("stand_g\xFC.toml", file_text(nominal_file));
  succeed("trace " + at("stand_g\xFC.toml") + quick + " --out " + at("o\xFC"));
  for (const std::string file : {"files.json", "summary.json"}) {
    EXPECT_THAT(file_text(at("o\xFC/" + file)), HasSubstr("stand_g\xEF\xBF\xBD.toml")) << file;
  }
}

TEST_F(OutputFolders, HoldFilesOfTheLastRunAlone) {
  const std::string rays = " --set trace.arriving_rays=4096";
  succeed("trace " + nominal_file + quick + rays + " --out " + at("o"));
  write("o/mine.csv", "mine");
  ASSERT_TRUE(fs::exists(at("o/rays_solar_array.tm25ray")));
  succeed("trace " + nominal_file + quick + " --out " + at("o"));
  EXPECT_FALSE(fs::exists(at("o/rays_solar_array.tm25ray")));
  EXPECT_TRUE(fs::exists(at("o/mine.csv")));
}

}  // namespace
}  // namespace photorque
