// `propagate --checkpoint` and that of `torque-map`: runs that are killed at random moments end as
// if they had not been.
#include <chrono>
#include <random>
#include <thread>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;

const std::string every = " --checkpoint 0.0005";  // 30 ms

class CheckpointCommand : public CommandTest {
 protected:
  // The exit status of `photorque ARGUMENTS`, or −1 where it was killed after so long.
  int killed_after(const std::string& arguments, std::chrono::milliseconds length) const {
    const pid_t child = start(arguments, at("stderr"));
    const auto end = std::chrono::steady_clock::now() + length;
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() >= end) ::kill(child, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  // Every number of a run. summary.json holds seconds of work.
  std::map<std::string, std::string> numbers(const std::string& folder) const {
    std::map<std::string, std::string> all;
    for (const auto& [name, text] : files(folder)) {
      if (name.ends_with(".csv") || name.ends_with(".aem")) all[name] = text;
    }
    return all;
  }

  // Kills a run until at least `least` were killed behind a checkpoint, then lets it end.
  void kill_until_done(const std::string& arguments, int least, int longest_ms) {
    std::mt19937 random(7);
    const fs::path state = at("o/" + arguments.substr(0, arguments.find(' ')) + ".checkpoint");
    int gone_on = 0;
    for (int i = 0; i < 400 && gone_on < least; ++i) {
      const bool has_state = fs::exists(state);
      const std::chrono::milliseconds length(
          std::uniform_int_distribution<int>(100, longest_ms)(random));
      const int status = killed_after(arguments + every + " --out " + at("o"), length);
      ASSERT_LE(status, 0) << file_text(at("stderr"));
      // A slow machine takes longer until there is something to go on from.
      if (status < 0 && !fs::exists(state)) longest_ms += longest_ms / 4;
      gone_on += has_state ? 1 : 0;
    }
    EXPECT_GE(gone_on, least);
    ASSERT_EQ(killed_after(arguments + every + " --out " + at("o"), std::chrono::minutes(5)), 0)
        << file_text(at("stderr"));
    EXPECT_FALSE(fs::exists(state));
  }
};

TEST_F(CheckpointCommand, KilledRunsEndAsIfTheyHadNotBeen) {
  const std::string run_it = "propagate " + attitude_file + " --set propagate.duration_s=1200";
  succeed(run_it + " --out " + at("whole"));
  kill_until_done(run_it, 6, 700);
  const auto whole = numbers("whole");
  EXPECT_TRUE(whole.contains("recording.csv"));
  EXPECT_EQ(numbers("o"), whole);
}

// Directions of sunlight, one after another, by rays and by quadrature.
TEST_F(CheckpointCommand, KilledTorqueMapsEndAsIfTheyHadNotBeen) {
  for (const std::string direct : {"rays", "auto"}) {
    const std::string run_it =
        "torque-map " + (shipped_scenes / "spacecraft/light_pressure.toml").string() +
        " --set torque_map.azimuth_step_deg=20 --set torque_map.elevation_step_deg=20"
        " --set torque_map.rays=4096 --set 'trace.direct=\"" +
        direct + "\"'";
    fs::remove_all(at("o"));
    const std::string whole = "whole_" + direct;
    succeed(run_it + " --out " + at(whole));
    kill_until_done(run_it, 2, 2000);
    EXPECT_TRUE(numbers(whole).contains("wrench_table_body.csv"));
    EXPECT_EQ(numbers("o"), numbers(whole));
  }
}

// Light that is traced at every exchange, tracker, battery and cells that warm up.
TEST_F(CheckpointCommand, KilledRunsInLightEndAsIfTheyHadNotBeen) {
  const std::string run_it =
      "propagate " + (shipped_scenes / "stasis/day.toml").string() +
      " --set propagate.duration_s=40 --set 'light.mode=\"trace\"' --set light.rays=1024";
  succeed(run_it + " --out " + at("whole"));
  kill_until_done(run_it, 4, 3000);
  const auto whole = numbers("whole");
  EXPECT_TRUE(whole.contains("power.csv"));
  EXPECT_EQ(numbers("o"), whole);
}

TEST_F(CheckpointCommand, StateOfAnotherRunIsRefused) {
  fs::copy_file(attitude_file, at("e.toml"));
  fs::copy_file(shipped_scenes / "stasis/light_torque.csv", at("light_torque.csv"));
  const std::string short_run = " --set propagate.duration_s=900 --out " + at("o") + every;
  for (int i = 0; i < 100 && !fs::exists(at("o/propagate.checkpoint")); ++i) {
    killed_after("propagate " + at("e.toml") + short_run, std::chrono::milliseconds(250 + 20 * i));
  }
  ASSERT_TRUE(fs::exists(at("o/propagate.checkpoint")));
  const std::string state = file_text(at("o/propagate.checkpoint"));
  const auto expect_refused = [&](const std::string& more, const std::string& found) {
    EXPECT_THAT(refused("propagate " + at("e.toml") + short_run + more),
                HasSubstr("propagate.checkpoint: found " + found))
        << more;
    EXPECT_EQ(file_text(at("o/propagate.checkpoint")).size(), state.size());
  };
  const std::string another = "a checkpoint of another program, experiment, seed or input file";
  expect_refused(" --set propagate.tolerance=1e-9", another);
  expect_refused(" --seed 5", another);
  std::ofstream(at("light_torque.csv"), std::ios::app) << "# one line more\n";
  expect_refused("", another);
  fs::copy_file(shipped_scenes / "stasis/light_torque.csv", at("light_torque.csv"),
                fs::copy_options::overwrite_existing);
  std::ofstream(at("e.toml"), std::ios::app) << "# one line more\n";
  expect_refused("", another);
  fs::copy_file(attitude_file, at("e.toml"), fs::copy_options::overwrite_existing);
  std::string damaged = state;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  write("o/propagate.checkpoint", damaged);
  expect_refused("", "a damaged checkpoint");
  write("o/propagate.checkpoint", state);
  succeed("propagate " + at("e.toml") + short_run);
}

TEST_F(CheckpointCommand, TakesMinutesAboveZero) {
  for (const char* minutes : {"0", "-1", "soon"}) {
    EXPECT_THAT(
        refused("propagate " + attitude_file + " --checkpoint " + minutes + " --out " + at("o")),
        HasSubstr("expected a number of minutes > 0"));
  }
}

}  // namespace
}  // namespace photorque
