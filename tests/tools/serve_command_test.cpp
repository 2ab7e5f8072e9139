// `serve` as its clients meet it: what it sends, when commands act, and that a run in lockstep is
// the one that `propagate` computes.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/tools/serve_client.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* served_platform = R"([platform]
topology = "tabletop"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
tilt_limit_deg = 30
[[disturbance]]
kind = "static_unbalance"
offset_m = [2e-6, -1e-6, -3e-5]
[[disturbance]]
kind = "floor_vibration"
acceleration_m_s2 = [5e-4, 5e-4, 1e-3]
frequency_Hz = 8
[[disturbance]]
kind = "mass_shift"
time_s = 1.0031
offset_m = [5e-7, 0, 0]
[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = 1.5e-5
[sensors.camera]
noise_arcsec = [37, 37, 12]
rate_Hz = 80
latency_s = 0.02
[sensors.gyro]
noise_rad_s = 2e-4
bias_rad_s = [1e-4, 0, 0]
bias_drift = 1e-5
[propagate]
duration_s = 4
initial_tilt_deg = 3
initial_rate_rad_s = [0.01, -0.005, 0.08]
initial_time_s = 0.5
)";

// Not constant for long, and of the measurement.
ClientTorque damping(const photorque_measurement_packet& packet) {
  const double sign = packet.now_tick % 50 < 25 ? 1.0 : -1.0;
  return {-0.01 * packet.gyro_rad_s[0], -0.01 * packet.gyro_rad_s[1], sign * 1e-4};
}

// A torque that names the tick it answers.
ClientTorque counting(const photorque_measurement_packet& packet) {
  return {1e-6 * static_cast<double>(packet.now_tick + 1), 0, 0};
}

// A file without the lines that name the run.
std::string content(const std::string& text) {
  std::istringstream lines(text);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("#") && !line.starts_with("COMMENT")) kept += line + "\n";
  }
  return kept;
}

std::vector<std::vector<double>> rows_of(const std::string& path) {
  std::vector<std::vector<double>> rows;
  for (const auto& cells : csv_rows(path)) {
    auto& row = rows.emplace_back();
    for (const std::string& cell : cells)
      row.push_back(cell.empty() ? std::nan("") : std::strtod(cell.c_str(), nullptr));
  }
  rows.erase(rows.begin());  // the header
  return rows;
}

class Served : public ServeCommand {
 protected:
  void SetUp() override {
    ServeCommand::SetUp();
    experiment_ = write("p.toml", served_platform);
  }
  std::vector<photorque_measurement_packet> in_lockstep(const std::string& keys,
                                                        const ClientLaw& law,
                                                        const std::string& folder = "s") {
    return serve(experiment_ + keys + " --set serve.mode=\\\"lockstep\\\" --out " + at(folder),
                 law);
  }
  // By `propagate` with the commands that acted.
  void expect_the_run_again(const std::string& keys, const std::string& rate_Hz = "160") {
    succeed("propagate " + experiment_ + keys + " --set propagate.tick_rate_Hz=" + rate_Hz +
            " --set propagate.output_rate_Hz=" + rate_Hz + " --set propagate.commands=\\\"" +
            at("s") + "/commands.csv\\\" --out " + at("p"));
    EXPECT_EQ(content(files("s").at("recording.csv")), content(files("p").at("recording.csv")));
  }

  std::string experiment_;
};

class Lockstep : public Served {};

TEST_F(Lockstep, IsTheRunThatPropagateComputesToTheBit) {
  const auto sent = in_lockstep("", damping);
  expect_the_run_again("");
  const auto served = files("s"), propagated = files("p");
  for (const char* name : {"time_history.csv", "attitude.aem"}) {
    EXPECT_EQ(content(served.at(name)), content(propagated.at(name))) << name;
  }
  // And what the client was sent is what the recording holds: all columns but those of the command,
  // which is not decided yet.
  const auto rows = rows_of(at("s/recording.csv"));
  ASSERT_EQ(sent.size() + 1, rows.size());
  for (size_t i = 0; i < sent.size(); ++i) {
    ASSERT_EQ(sent[i].header.tick, i);
    EXPECT_EQ(sent[i].t_s, rows[i][0]);
    for (size_t k = 0; k < 4; ++k) {
      if (i % 2 == 1) {
        EXPECT_TRUE(std::isnan(sent[i].attitude[k]));  // of a camera at half the rate
      } else {
        EXPECT_EQ(sent[i].attitude[k], rows[i][1 + k]) << i;
      }
    }
    for (size_t k = 0; k < 3; ++k) EXPECT_EQ(sent[i].gyro_rad_s[k], rows[i][5 + k]) << i;
    if (i == 0) continue;
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(sent[i].command_body_N_m[k], rows[i - 1][8 + k]) << i;
    }
  }
}

// Lockstep with everything else that a step may end at: switches, other tick rates, a start that is
// no binary fraction.
TEST_F(Lockstep, IsTheSameAtAnotherRate) {
  const std::string odd = " --set propagate.initial_time_s=0.1 --set propagate.duration_s=2";
  in_lockstep(odd + " --set serve.rate_Hz=333", damping);
  expect_the_run_again(odd, "333");
}

// A camera whose noise follows from its geometry, at the attitude and rate of every tick.
TEST_F(Lockstep, SendsReadingsOfAMarkerCamera) {
  experiment_ = source_folder + "/scenes/stasis/camera.toml --set propagate.duration_s=0.5";
  const auto sent = in_lockstep("", damping);
  const auto rows = rows_of(at("s/recording.csv"));
  ASSERT_EQ(sent.size() + 1, rows.size());
  for (size_t i = 0; i < sent.size(); ++i) {
    for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(sent[i].attitude[k], rows[i].at(1 + k), 1e-13) << i;
  }
  expect_the_run_again("");
}

// Delays of 5 and 13 ms are one and three ticks of 6.25 ms: readings come a tick later, and a
// command acts three ticks after the tick that it answers.
TEST_F(Lockstep, LinksDelayByWholeTicks) {
  const auto sent = in_lockstep(
      " --set serve.to_client.delay_s=0.005 --set serve.from_client.delay_s=0.013"
      " --set propagate.duration_s=1",
      counting);
  ASSERT_EQ(sent.size(), 160u);
  EXPECT_EQ(sent[0].flags & PHOTORQUE_NEW, 0u);
  for (size_t i = 1; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].now_tick, i);
    EXPECT_EQ(sent[i].header.tick + 1, i);
    EXPECT_NE(sent[i].flags & PHOTORQUE_NEW, 0u);
  }
  const auto rows = rows_of(at("s/recording.csv"));
  for (size_t i = 0; i + 1 < rows.size(); ++i) {
    EXPECT_DOUBLE_EQ(rows[i][8], i < 3 ? 0.0 : 1e-6 * static_cast<double>(i - 2)) << i;
  }
}

TEST_F(Lockstep, LosesTheSamePacketsAgain) {
  std::vector<std::string> recordings;
  for (const std::string name : {"a", "b"}) {
    in_lockstep(
        " --set serve.to_client.loss=0.2 --set serve.from_client.loss=0.2"
        " --set serve.from_client.jitter_s=0.01",
        damping, name);
    recordings.push_back(content(files(name).at("recording.csv")));
    // 640 packets, a fifth of them, within 4.5 standard deviations.
    const double lost = figure("commands_lost_by_link", name);
    EXPECT_NEAR(lost, 128.0, 4.5 * std::sqrt(640 * 0.2 * 0.8));
    EXPECT_GT(figure("commands_overtaken", name), 10.0);
  }
  EXPECT_EQ(recordings[0], recordings[1]);
}

// A trace of 5 ms and a loss in turn: of the commands every second acts, a tick late.
TEST_F(Lockstep, LinksFollowAMeasuredTrace) {
  write("trace.csv", "delay_s\n0.005\n-1\n");
  in_lockstep(" --set serve.from_client.trace=\\\"trace.csv\\\" --set propagate.duration_s=1",
              counting);
  const auto rows = rows_of(at("s/recording.csv"));
  for (size_t i = 1; i + 1 < rows.size(); ++i) {
    const size_t even = (i - 1) / 2 * 2;
    EXPECT_DOUBLE_EQ(rows[i][8], 1e-6 * static_cast<double>(even + 1)) << i;
  }
}

// The run waits for no client, and nothing is commanded.
TEST_F(Lockstep, GoesOnAloneAfterAGoodbye) {
  serve_to(experiment_ + " --set propagate.duration_s=2 --set serve.mode=\\\"lockstep\\\" --out " +
               at("s"),
           [](ServeClient& client) {
             client.follow([](const auto&) { return ClientTorque{1e-4, 0, 0}; }, 50);
             client.send_header(PHOTORQUE_GOODBYE);
           });
  const auto rows = rows_of(at("s/recording.csv"));
  ASSERT_EQ(rows.size(), 321u);
  for (size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].at(8), i < 50 ? 1e-4 : 0.0) << i;
}

class Paced : public Served {};

// A command that is not renewed ends after hold_s; the client's next acts again.
TEST_F(Paced, CommandsEndWhenTheyAreNotRenewed) {
  serve_to(experiment_ + " --set propagate.duration_s=3 --set serve.hold_s=0.6 --out " + at("s"),
           [](ServeClient& client) {
             const auto torque = [](const auto&) { return ClientTorque{0, 0, 1e-4}; };
             client.follow(torque, 20);
             std::this_thread::sleep_for(std::chrono::milliseconds(1500));
             client.follow(torque);
           });
  auto rows = rows_of(at("s/commands.csv"));
  // Whether the first answer was in time for the first tick is the machine's affair.
  ASSERT_FALSE(rows.empty());
  if (rows.front()[3] == 0.0) rows.erase(rows.begin());
  // The command, nothing, the command; on a busy machine perhaps another.
  ASSERT_GE(rows.size(), 3u);
  for (size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i][3], i % 2 == 0 ? 1e-4 : 0.0) << i;
  EXPECT_GT(rows[1][0] - rows[0][0], 0.6);
}

// A client vanishes without goodbye: its torque ends after silence_s, and the next client's
// commands act from its first on, though it counts from the start.
TEST_F(Paced, ControlEndsWithTheSession) {
  serve_to(experiment_ + " --set propagate.duration_s=3 --set serve.silence_s=0.3 --out " + at("s"),
           [&](ServeClient& first) {
             first.follow([](const auto&) { return ClientTorque{0, 0, 1e-4}; }, 100);
             std::this_thread::sleep_for(std::chrono::milliseconds(900));
             ServeClient second(port_when_known());
             second.follow([](const auto&) { return ClientTorque{0, 0, -2e-4}; });
           });
  auto rows = rows_of(at("s/commands.csv"));
  ASSERT_FALSE(rows.empty());
  if (rows.front()[3] == 0.0) rows.erase(rows.begin());
  ASSERT_GE(rows.size(), 3u);
  EXPECT_EQ(rows[0][3], 1e-4);
  EXPECT_EQ(rows[1][3], 0.0);
  EXPECT_EQ(rows[2][3], -2e-4);
  EXPECT_GT(rows[2][0] - rows[1][0], 0.2);
  EXPECT_EQ(figure("sessions", "s"), 2.0);
  EXPECT_GE(figure("silences_of_client", "s"), 1.0);
  EXPECT_EQ(figure("commands_overtaken", "s"), 0.0);
  const std::string events = content(files("s").at("session_events.csv"));
  EXPECT_THAT(events, testing::HasSubstr("the client is silent for 0.3 s: no torque"));
  EXPECT_THAT(outcome_.out, testing::HasSubstr("a session begins, from 127.0.0.1:"));
}

// Ten ticks a second, and tens of thousands of packets: a tick reads so many of them and no more.
TEST_F(Paced, ReadsABoundedNumberOfPacketsATick) {
  std::atomic<bool> over = false;
  std::thread flood;
  serve_to(experiment_ + " --set serve.rate_Hz=10 --set propagate.duration_s=1 --out " + at("s"),
           [&](ServeClient& client) {
             flood = std::thread([&] {
               const ServeClient stranger(port_when_known());
               while (!over) stranger.send_bytes("nonsense", 8);
             });
             client.follow([](const auto&) { return ClientTorque{0, 0, 0}; }, 1);
           });
  over = true;
  flood.join();
  EXPECT_GT(figure("ticks_at_packet_limit", "s"), 0.0);
  EXPECT_LE(figure("packets_refused", "s"), 12 * 256.0);
}

TEST_F(Paced, KeepsTheClockAndReportsDeadlines) {
  const auto begin = std::chrono::steady_clock::now();
  const auto sent = serve(experiment_ + " --set propagate.duration_s=1 --out " + at("s"), damping);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_GT(took.count(), 1.0);
  EXPECT_EQ(sent.size(), 160u);
  // By the server's own clock no measurement left before it was due.
  for (const auto& packet : sent) {
    const double due_ns = 6.25e6 * static_cast<double>(packet.header.tick);
    EXPECT_GE(static_cast<double>(packet.header.sent_ns - sent[0].header.sent_ns) + 1e6, due_ns);
  }
  EXPECT_EQ(figure("ticks", "s"), 160.0);
  for (const char* name : {"ticks_missed", "lateness_p50_us", "lateness_p99_us",
                           "lateness_p99_99_us", "computing_p99_99_us"}) {
    EXPECT_GE(figure(name, "s"), 0.0) << name;
  }
  EXPECT_TRUE(files("s").contains("deadlines.png"));
  // Whenever the commands came, what acted is known, and the run can be repeated.
  expect_the_run_again(" --set propagate.duration_s=1");
}

TEST_F(Paced, WrongInputIsOneLineAndExitTwo) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"serve.address=\\\"localhost\\\"", "expected an IPv4 address"},
      {"serve.address=\\\"192.0.2.1\\\"", "expected an address of this machine"},
      {"serve.port=70000", "serve.port"},
      {"serve.to_client.loss=1.5", "serve.to_client.loss"},
      {"serve.to_client.trace=\\\"none.csv\\\"", "a file beside"},
      {"serve.rate=100", "perhaps \"rate_Hz\""},
      {"serve.on_miss=\\\"cry\\\"", "catch_up"},
  };
  for (const auto& [key, message] : cases) {
    EXPECT_THAT(refused("serve " + experiment_ + " --set " + key + " --out " + at("o")),
                HasSubstr(message))
        << key;
  }
  const Outcome silent =
      run("serve " + experiment_ + " --set serve.port=0 --set serve.client_timeout_s=0.1 --out " +
          at("o"));
  EXPECT_EQ(silent.status, 3);
  EXPECT_THAT(silent.err, HasSubstr("no client came"));
}

}  // namespace
}  // namespace photorque
