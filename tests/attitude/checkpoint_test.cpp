// Runs that are interrupted and continued are equal to uninterrupted runs, bit for bit.
#include <gtest/gtest.h>

#include <cstring>

#include "attitude/propagation/recorded.h"
#include "scenes/experiment/toml.h"
#include "tests/attitude/settings_bench.h"

namespace photorque {
namespace {

PropagationRun run_of(const std::string& toml) {
  return read_propagation(Settings(parse_toml(toml, "run.toml")));
}

// Sensors with latency, drift and pauses; commands; a cable; an appendage with extra states.
const std::string pendulum = R"([platform]
topology = "tabletop"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
tilt_limit_deg = 30
battery_capacity_Ah = 0.02
[[disturbance]]
kind = "static_unbalance"
offset_m = [2e-6, -1e-6, -3e-5]
[[disturbance]]
kind = "battery_discharge"
shift_m_per_Ah = [1e-5, 0, 0]
[[disturbance]]
kind = "flexible_mode"
axis = [1, 0, 0]
frequency_Hz = 0.7
damping = 0.02
inertia_kg_m2 = 0.01
[sensors.camera]
noise_arcsec = [37, 37, 12]
rate_Hz = 3
latency_s = 0.37
[sensors.gyro]
noise_rad_s = 2e-4
bias_drift = 1e-5
rate_Hz = 4
[sensors.encoder]
resolution_arcsec = 20
[propagate]
duration_s = 60
output_rate_Hz = 10
history_rows = 150
initial_tilt_deg = 6
initial_rate_rad_s = [0.01, -0.005, 0.08]
initial_charge_Ah = 0.019
[[propagate.command]]
time_s = 11
torque_N_m = [0, 2e-5, 0]
battery_current_A = 0.5
[[propagate.command]]
time_s = 30.03
battery_current_A = -0.1
)";
// A platform that slows down and sticks, which Newton's method integrates.
const std::string sticking = R"([platform]
topology = "tabletop"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
[[disturbance]]
kind = "turbine_torque"
torque_N_m = 4e-6
[[disturbance]]
kind = "dry_friction"
torque_N_m = 1e-5
[propagate]
duration_s = 2000
output_rate_Hz = 0.5
initial_rate_rad_s = [0, 0, 0.02]
)";
// Several rows in a step, and steps without a row.
const std::string sliding = R"([platform]
topology = "planar"
mass_kg = 2
[[disturbance]]
kind = "sliding_drag"
coefficient_kg_s = 0.03
[sensors.position]
noise_m = 1e-4
noise_m_s = 1e-3
[propagate]
duration_s = 20
output_rate_Hz = 7
longest_step_s = 0.31
initial_velocity_m_s = [0.3, 0.4]
)";

// The history has at most 150 of 601 rows and ends with the last. The figures are those of the
// whole run.
TEST(Propagation, AShortHistoryEndsWithTheRun) {
  const PropagationRun run = run_of(pendulum);
  const PropagationResult result = propagate(run);
  const std::vector<double>& t = result.product.tables.front().column("t_s").values;
  EXPECT_LE(t.size(), 150u);
  EXPECT_GE(t.size(), 75u);
  EXPECT_EQ(t.back(), 60.0);
  double largest_rad = 0.0;
  for (const PlatformState& state : result.states) {
    largest_rad = std::max(largest_rad, tilt_rad(state));
  }
  const std::vector<double>& kept_deg = result.product.tables.front().column("tilt_deg").values;
  EXPECT_LT(*std::ranges::max_element(kept_deg), largest_rad / degree_rad);  // not trivial
  for (const Quantity& q : result.product.quantities) {
    if (q.name == "final_time_s") {
      EXPECT_EQ(q.estimate.value, 60.0);
    }
    if (q.name == "largest_tilt_deg") {
      EXPECT_GE(q.estimate.value, largest_rad / degree_rad);
      EXPECT_LT(q.estimate.value, largest_rad / degree_rad + 1e-4);  // between two rows
    }
  }
}

// The result of a run that is stopped and continued again and again after the given number of
// steps.
PropagationResult in_pieces(const PropagationRun& run, int steps, int& pieces) {
  std::string state;
  for (pieces = 1;; ++pieces) {
    RecordedRun recorded(run, {});
    if (!state.empty()) {
      Snapshot kept(state);
      recorded.keep(kept);
      EXPECT_TRUE(kept.is_whole());
    }
    int taken = 0;
    while (taken < steps && recorded.advance()) {
      recorded.record();
      ++taken;
    }
    if (taken < steps) return recorded.result();
    Snapshot snapshot;
    recorded.keep(snapshot);
    state = snapshot.bytes();
  }
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0) << what;
}

void expect_same(const PropagationResult& a, const PropagationResult& b) {
  expect_same(a.recording.time_s, b.recording.time_s, "time");
  ASSERT_EQ(a.recording.channels.size(), b.recording.channels.size());
  for (size_t i = 0; i < a.recording.channels.size(); ++i) {
    const Channel &one = a.recording.channels[i], &other = b.recording.channels[i];
    EXPECT_EQ(one.name, other.name);
    expect_same(one.values, other.values, one.name.c_str());
  }
  ASSERT_EQ(a.states.size(), b.states.size());
  for (size_t i = 0; i < a.states.size(); ++i) {
    EXPECT_EQ(a.states[i].time_s, b.states[i].time_s);
    EXPECT_EQ(a.states[i].lab_from_body.coeffs(), b.states[i].lab_from_body.coeffs());
    EXPECT_EQ(a.states[i].rate_body_rad_s, b.states[i].rate_body_rad_s);
    EXPECT_EQ(a.states[i].charge_drawn_C, b.states[i].charge_drawn_C);
    EXPECT_EQ(a.states[i].extra, b.states[i].extra);
  }
  ASSERT_EQ(a.events.size(), b.events.size());
  for (size_t i = 0; i < a.events.size(); ++i) {
    EXPECT_EQ(a.events[i].name, b.events[i].name);
    EXPECT_EQ(a.events[i].time_s, b.events[i].time_s);
  }
  const auto &history = a.product.tables.front(), &other = b.product.tables.front();
  ASSERT_EQ(history.columns.size(), other.columns.size());
  for (size_t c = 0; c < history.columns.size(); ++c) {
    expect_same(history.columns[c].values, other.columns[c].values,
                history.columns[c].name.c_str());
  }
  EXPECT_EQ(a.statistics.steps, b.statistics.steps);
  EXPECT_EQ(a.statistics.iterations, b.statistics.iterations);
  EXPECT_EQ(a.statistics.rejected, b.statistics.rejected);
  EXPECT_EQ(a.statistics.stiff, b.statistics.stiff);
}

TEST(Checkpoint, RunsInPiecesAreThoseInOne) {
  for (const std::string& toml : {pendulum, sticking, sliding}) {
    SCOPED_TRACE(toml.substr(0, 400));
    const PropagationRun run = run_of(toml);
    const PropagationResult whole = propagate(run);
    for (const int steps : {1, 2, 7, 40}) {
      int pieces = 0;
      const PropagationResult result = in_pieces(run, steps, pieces);
      EXPECT_GE(pieces, whole.statistics.steps / steps / 2);
      expect_same(whole, result);
    }
  }
}

TEST(Checkpoint, RunsContainTheirSubject) {
  const PropagationResult swings = propagate(run_of(pendulum));
  ASSERT_FALSE(swings.events.empty());
  EXPECT_EQ(swings.events.front().name, "battery_empty");
  EXPECT_FALSE(swings.states.back().extra.empty());
  EXPECT_GT(propagate(run_of(sticking)).statistics.stiff, 0);
  EXPECT_NE(propagate(run_of(sliding)).recording.find("velocity_x_m_s"), nullptr);
}

TEST(Checkpoint, StatesOfOtherRunsAreRefused) {
  const PropagationRun slides = run_of(sliding), swings = run_of(pendulum);
  RecordedRun kept(slides, {});
  while (kept.advance()) kept.record();
  Snapshot snapshot;
  kept.keep(snapshot);
  const std::string state = snapshot.bytes();
  for (const std::string& bytes : {state, state.substr(0, state.size() / 2), std::string("x")}) {
    RecordedRun other(swings, {});
    Snapshot from(bytes);
    other.keep(from);
    EXPECT_FALSE(from.is_whole());
  }
}

}  // namespace
}  // namespace photorque
