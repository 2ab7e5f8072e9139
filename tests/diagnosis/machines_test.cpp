// Machines that are no table-top platforms: one axis, free bodies, any channels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "attitude/estimation/segments.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/propagation/run.h"
#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/errors.h"
#include "diagnosis/attitude/diagnose.h"
#include "tests/diagnosis/machine_bench.h"
#include "tests/noise.h"

namespace photorque {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

const char* const wheel_toml = R"([platform]
topology = "one_axis"
[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = { value = 1e-3, sigma = 1e-2 }
[sensors.gyro]
noise_rad_s = 0.003
)";

// I ω' = −τ − k ω² from ω₀: ω = √(τ/k) tan(atan(ω₀ √(k/τ)) − √(τk) t/I), by separation.
double coasting_rad_s(double time_s, double dry = 0.01, double form = 1.2e-4) {
  constexpr double start_rad_s = 30.0;
  const double unit = std::sqrt(dry / form);
  return unit * std::tan(std::atan(start_rad_s / unit) - std::sqrt(dry * form) * time_s);
}

// Five minutes of a rate, with the noise of wheel_toml.
template <class Rate>
Channel rate_of_wheel(uint64_t seed, const Rate& rate_rad_s) {
  return noisy("gyro_z_rad_s", sampled(0.25, 1200, rate_rad_s), 0.003, seed);
}

TEST(Machines, AWheelThatCoastsDownIsNamedByItsDryTorqueAndItsDrag) {
  constexpr double dry = 0.01, form = 1.2e-4;
  const Channel rate = rate_of_wheel(3, [](double t) { return coasting_rad_s(t, dry, form); });
  const Diagnosis d = diagnosed(machine(wheel_toml), 0.25, {rate});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("dry_friction", "air_pressure_drag"));
  for (const FoundEffect& effect : d.effects) {
    const double truth = effect.kind == "dry_friction" ? dry : form;
    const FittedParameter& p = effect.parameters.front();
    EXPECT_NEAR(p.value[0], truth, std::max(5.0 * p.sigma[0], 0.02 * truth)) << effect.kind;
  }
  ASSERT_TRUE(d.holdout);
  EXPECT_LT(d.holdout->chi2_per_sample_after, 2.0);
  EXPECT_GT(d.holdout->chi2_per_sample_before, 100.0);
  // One way only a steady torque of any origin brakes like a dry one: one name, and a word on that.
  EXPECT_THAT(d.warnings, Contains(HasSubstr("rotates in one sense only")));
  for (const Alternative& a : d.alternatives) EXPECT_THAT(a.kinds, Not(Contains("room_draft")));
}

// A wheel with a hum that no law explains, beside which the two names stand. Each gate that they
// pass takes them away where it asks for what nothing can give.
TEST(Machines, NamesBesideTheRestPassEveryGate) {
  const Channel rate = rate_of_wheel(3, [](double t) {
    const double i = t / 0.25;
    return coasting_rad_s(t) + 0.05 * std::sin(0.31 * i + 0.002 * i * i);
  });
  const std::vector<NamedRecording> runs = {{"wheel.csv", recording_of(0.25, {rate})}};
  const auto named = [&](const DiagnoseOptions& options) {
    return diagnose(machine(wheel_toml), runs, {}, options);
  };
  const Diagnosis d = named({});
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("dry_friction", "air_pressure_drag"));
  EXPECT_THAT(d.warnings, Contains(HasSubstr("predicted better with it than without it")));
  DiagnoseOptions segments, held_out, errors;
  segments.limits.discrepancy.min_sigma = 1e9;
  held_out.limits.discrepancy.max_held_growth = -1e9;
  errors.limits.decision.min_significance = 1e9;
  for (const DiagnoseOptions& mutant : {segments, held_out, errors}) {
    EXPECT_THAT(kinds_of(named(mutant)), testing::IsEmpty());
  }
}

TEST(Machines, ABodyThatTurnsFreelyLacksNothing) {
  // A body with two equal moments precesses: ωx + i ωy turns with λ = (Iz − Ix) ωz / Ix (Landau and
  // Lifshitz, Mechanics, section 36).
  constexpr double Ix = 0.02, Iz = 0.03, spin = 8.0, across = 2.0, interval_s = 0.01;
  Noise noise(5, 0.002);
  std::vector<Channel> gyro = {{"gyro_x_rad_s", {}}, {"gyro_y_rad_s", {}}, {"gyro_z_rad_s", {}}};
  for (int i = 0; i < 600; ++i) {
    const double angle = (Iz - Ix) / Ix * spin * interval_s * i;
    gyro[0].values.push_back(across * std::cos(angle) + noise());
    gyro[1].values.push_back(across * std::sin(angle) + noise());
    gyro[2].values.push_back(spin + noise());
  }
  const NominalModel nominal = machine(R"([platform]
topology = "free"
inertia_kg_m2 = { value = [[0.02, 0, 0], [0, 0.02, 0], [0, 0, 0.03]], sigma = [[0, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]] }
[sensors.gyro]
noise_rad_s = 0.002
)");
  const Diagnosis d = diagnosed(nominal, interval_s, gyro);
  EXPECT_EQ(d.verdict, Verdict::consistent) << d.sentence;
  EXPECT_NEAR(d.chi2_per_sample_after, 1.0, 5.0 * std::sqrt(2.0 / (3.0 * 450.0)));
}

// Rates that no free body has: χ² per sample of every fit is above 10⁴. The fitted moments are far
// from their stated ones, which contradicts nothing.
TEST(Machines, AModelThatDescribesNothingContradictsNoStatedValue) {
  Noise noise(1, 0.002);
  std::vector<Channel> gyro = {{"gyro_x_rad_s", {}}, {"gyro_y_rad_s", {}}, {"gyro_z_rad_s", {}}};
  for (int i = 0; i < 80; ++i) {
    const double phase = 0.22 * i + 0.5;
    gyro[0].values.push_back(2.0 * std::sin(phase) + 0.3 + noise());
    gyro[1].values.push_back(0.8 * std::pow(std::sin(phase), 2) + noise());
    gyro[2].values.push_back(0.5 * std::sin(2.0 * phase - 1.0) + noise());
  }
  const NominalModel nominal = machine(R"([platform]
topology = "free"
[platform.inertia_kg_m2]
value = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
sigma = [[0, 0.2, 0.2], [0.2, 0.4, 0.2], [0.2, 0.2, 0.4]]
[sensors.gyro]
noise_rad_s = 0.002
)");
  const Diagnosis d = diagnosed(nominal, 0.05, gyro);
  EXPECT_EQ(d.verdict, Verdict::unexplained) << d.sentence;
  EXPECT_GT(d.chi2_per_sample_after, 1e4);
  EXPECT_THAT(d.warnings, testing::Not(Contains(HasSubstr("σ"))));
}

// Angular momentum in the inertial frame is conserved at any speed of a wheel on board.
TEST(Machines, AWheelExchangesMomentumWithItsBody) {
  NominalModel nominal = machine(R"([platform]
topology = "free"
inertia_kg_m2 = [[0.02, 0, 0], [0, 0.03, 0], [0, 0, 0.04]]
[[disturbance]]
kind = "wheel_momentum"
inertia_kg_m2 = 1e-4
)");
  constexpr double wheel_kg_m2 = 1e-4, speed_up_rad_s2 = 300.0, duration_s = 2.0;
  ZeroOrderHold held;
  held.wheel.acceleration_rad_s2 = {0.0, 0.0, speed_up_rad_s2};
  nominal.model.schedule.append(-1.0, held);
  nominal.model.schedule.held.front().wheel.from_s = 0.0;
  const Dynamics dynamics(nominal.model);
  PlatformState start = dynamics.initial_state({2.0, -1.0, 0.5});
  const PlatformState end =
      propagate(dynamics, start, std::array{duration_s}, {.tolerance = 1e-10}).states.front();
  const auto momentum = [&](const PlatformState& s, double wheel_rad_s) {
    const Vec3 body = nominal.model.platform.inertia_kg_m2 * s.rate_body_rad_s +
                      wheel_kg_m2 * wheel_rad_s * Vec3::UnitZ();
    return Vec3(s.lab_from_body * body);
  };
  const Vec3 before = momentum(start, 0.0), after = momentum(end, speed_up_rad_s2 * duration_s);
  EXPECT_LT((after - before).norm(), 1e-8 * before.norm());
  EXPECT_GT((end.rate_body_rad_s - start.rate_body_rad_s).norm(), 1.0);
}

TEST(Machines, APendulumSwingsAboutItsAxisAlone) {
  // Small swings of a compound pendulum: ω₀ = √(m g l / I) (Huygens). The product of inertia would
  // turn it about y and z if its bearings let it.
  const NominalModel nominal = machine(R"([platform]
topology = "one_axis"
axis = "x"
mass_kg = 2
inertia_kg_m2 = [[0.5, 0.1, 0], [0.1, 0.6, 0], [0, 0, 0.7]]
[[disturbance]]
kind = "static_unbalance"
offset_m = [0, 0, -0.2]
)");
  const Dynamics dynamics(nominal.model);
  PlatformState start = dynamics.initial_state();
  constexpr double amplitude_rad = 1e-4;
  start.lab_from_body = Quat(Eigen::AngleAxisd(amplitude_rad, Vec3::UnitX()));
  const double rate = std::sqrt(2.0 * standard_gravity_m_s2 * 0.2 / 0.5), time_s = 3.0;
  const PlatformState end =
      propagate(dynamics, start, std::array{time_s}, {.tolerance = 1e-12}).states.front();
  EXPECT_NEAR(end.lab_from_body.x(), 0.5 * amplitude_rad * std::cos(rate * time_s), 1e-10);
  EXPECT_EQ(end.lab_from_body.y(), 0.0);
  EXPECT_EQ(end.rate_body_rad_s.y(), 0.0);
  EXPECT_EQ(end.rate_body_rad_s.z(), 0.0);
}

TEST(Machines, ColumnsStateTheirContent) {
  Platform wheel;
  wheel.topology = Topology::one_axis;
  const Recording one = recording_of(
      1.0, {{"roll_rad", {0.1, 7.0}}, {"thruster", {0.0, 1.0}}, {"gas_Pa", {1.0, 1.0}}});
  const MotionColumns columns(one, wheel, "one.csv");
  EXPECT_THAT(columns.sees_axis(), ElementsAre(false, false, true));
  EXPECT_FALSE(columns.has_event(0));
  EXPECT_TRUE(columns.has_event(1));
  EXPECT_THAT(columns.unused(), ElementsAre("gas_Pa"));
  const Vec3 turned = columns.attitude(0) * Vec3::UnitX();
  EXPECT_NEAR(turned.y(), std::sin(0.1), 1e-15);

  const Recording angles =
      recording_of(1.0, {{"roll_rad", {pi / 2}}, {"pitch_rad", {0.0}}, {"yaw_rad", {pi / 2}}});
  const MotionColumns euler(angles, {}, "angles.csv");
  // Body z goes to −y by the roll, then to x by the yaw.
  EXPECT_NEAR((euler.attitude(0) * Vec3::UnitZ() - Vec3::UnitX()).norm(), 0.0, 1e-15);

  const Recording none = recording_of(1.0, {{"gas_Pa", {1.0}}});
  EXPECT_THROW(MotionColumns(none, {}, "none.csv"), InputError);
}

TEST(Machines, RecordingsAreCutWhereSomethingHappened) {
  Platform spacecraft;
  spacecraft.topology = Topology::one_axis;
  Channel angle{"angle_rad", {}}, thruster{"thruster", {}};
  Noise noise(7, 1e-7);
  for (int i = 0; i < 60; ++i) {
    // Two segments of other rates, the firing noted in row 20; in row 40 one that was not noted.
    const double t = i < 20 ? i : i < 40 ? 20.0 - (i - 20) : 3.0 * (i - 40);
    angle.values.push_back(1e-5 * t + noise());
    thruster.values.push_back(i == 20 ? 1.0 : 0.0);
  }
  Recording recording = recording_of(10.0, {angle, thruster});
  const Segments cut = observe_segments(recording, "roll.csv", spacecraft);
  EXPECT_EQ(cut.events, 1);
  EXPECT_EQ(cut.kinks, 1);
  ASSERT_EQ(cut.all.size(), 3u);
  EXPECT_EQ(cut.all[0].blocks(), 20u);
  EXPECT_DOUBLE_EQ(cut.all[1].time_s.front(), 210.0);
  EXPECT_DOUBLE_EQ(cut.all[2].time_s.front(), 410.0);

  // A clock that jumps by years.
  for (size_t i = 10; i < recording.rows(); ++i) recording.time_s[i] += 1e8;
  recording.report.gaps = {{recording.time_s[9], recording.time_s[10]}};
  const Segments jumped = observe_segments(recording, "roll.csv", spacecraft);
  EXPECT_EQ(jumped.long_gaps, 1);
  EXPECT_EQ(jumped.all.size(), 4u);
}

// Steps of an encoder and decaying oscillations are not kinks: an angle that turns evenly by a
// tenth of a step a row, one of an amplitude that falls to e^-5, and a swing counted in steps of
// 0.09° that a file rounds to 0.01°.
TEST(Machines, StepsOfAnEncoderAndTheBeginningOfADecayAreNoKinks) {
  Platform axle;
  axle.topology = Topology::one_axis;
  Noise noise(23, 1e-4);
  Channel counted{"angle_rad", {}}, swings = counted, kicked = counted;
  for (int i = 0; i < 6000; ++i) {
    counted.values.push_back(0.01 * std::floor(0.1 * i));
    const double t = 0.1 * i;
    swings.values.push_back(0.5 * std::exp(-t / 120.0) * std::cos(t) + noise());
    kicked.values.push_back(swings.values.back() + 0.8 * std::max(0.0, t - 55.0));
  }
  Channel rounded{"angle_rad", Swing{120.0, 2.3, 0.19, 0.0}.from(1.1, 0.001, 5000)};
  for (double& angle_rad : rounded.values) {
    const double counted_deg = 0.09 * std::floor(angle_rad / degree_rad / 0.09);
    angle_rad = 0.01 * std::round(counted_deg / 0.01) * degree_rad;
  }
  for (const Channel& channel : {counted, swings, rounded}) {
    const Segments cut = observe_segments(recording_of(0.1, {channel}), "axle.csv", axle);
    EXPECT_EQ(cut.kinks, 0);
    EXPECT_EQ(cut.all.size(), 1U);
  }
  // A blow in the middle of the swing is one.
  EXPECT_GE(observe_segments(recording_of(0.1, {kicked}), "axle.csv", axle).kinks, 1);
}

// A drive holds the wheel for 60 s before it coasts; now and then a count is lost.
Channel driven_then_coasting(double noise_rad_s) {
  Noise noise(13, noise_rad_s);
  Channel rate{"gyro_z_rad_s", {}};
  for (int i = 0; i < 1500; ++i) {
    const double t = 0.25 * i, lost = i % 301 < 2 ? 2.0 / 3.0 : 1.0;
    rate.values.push_back(lost * coasting_rad_s(std::max(0.0, t - 60.0)) + noise());
  }
  return rate;
}

TEST(Machines, TheDrivenPartOfARunIsOmitted) {
  const NominalModel wheel = machine(wheel_toml);
  const Recording recording = recording_of(0.25, {driven_then_coasting(0.003)});
  const Segments cut = observe_segments(recording, "wheel.csv", wheel.model.platform);
  ASSERT_EQ(cut.all.size(), 1u);
  // Not before it let go, and at most two seconds after.
  EXPECT_GT(cut.all[0].time_s.front(), 59.9);
  EXPECT_LT(cut.all[0].time_s.front(), 62.0);
  EXPECT_DOUBLE_EQ(cut.all[0].time_s.back(), recording.time_s.back());
  ASSERT_EQ(cut.exclusions.size(), 1u);
  EXPECT_THAT(cut.exclusions[0], HasSubstr("another torque acts before"));

  const Diagnosis d = diagnose(wheel, {{"wheel.csv", recording}}, {});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("dry_friction", "air_pressure_drag"));
}

TEST(Machines, MotionUnderOneLawIsNotCut) {
  Platform axle;
  axle.topology = Topology::one_axis;
  Noise noise(17, 0.003);
  Channel stops{"gyro_z_rad_s", {}}, swings = stops, commanded = stops,
                                     command{"command_z_N_m", {}}, even = stops;
  for (int i = 0; i < 1500; ++i) {
    const double t = 0.25 * i;
    stops.values.push_back(std::max(0.0, 30.0 - 0.15 * t) + noise());  // dry friction alone
    swings.values.push_back(std::sin(0.4 * t) * std::exp(-t / 200.0) + noise());
    commanded.values.push_back(30.0 + 0.15 * std::max(0.0, t - 60.0) + noise());
    command.values.push_back(t < 60.0 ? 0.0 : 0.15);
    even.values.push_back(2.0);  // a rate that never changes by a digit
  }
  for (const std::vector<Channel>& channels :
       {std::vector<Channel>{stops}, {swings}, {commanded, command}, {even}}) {
    const Segments cut = observe_segments(recording_of(0.25, channels), "axle.csv", axle);
    EXPECT_TRUE(cut.exclusions.empty()) << cut.exclusions.front();
    EXPECT_EQ(cut.all.size(), 1U);
    EXPECT_EQ(cut.all.front().blocks(), 1500U);
  }
}

// A dry torque that differs from run to run, guessed so large that the wheel would stop half-way.
TEST(Machines, DifferencesBetweenRunsDoNotHideCommonEffects) {
  const NominalModel wheel = machine(std::string(wheel_toml) + R"(
[[disturbance]]
kind = "dry_friction"
torque_N_m = { value = 5e-2, sigma = 5e-2 }
per_recording = true
)");
  Noise noise(19, 0.003);
  std::vector<NamedRecording> runs;
  for (const double dry : {0.008, 0.010, 0.013}) {
    Channel rate{"gyro_z_rad_s", {}};
    for (int i = 0; i < 1200; ++i) {
      rate.values.push_back(coasting_rad_s(0.25 * i, dry) + noise());
    }
    runs.push_back({"run.csv", recording_of(0.25, {rate})});
  }
  const Diagnosis d = diagnose(wheel, {runs[0], runs[1]}, {runs[2]});
  EXPECT_THAT(kinds_of(d), ElementsAre("air_pressure_drag"));
  const FittedParameter& drag = d.effects.front().parameters.front();
  EXPECT_NEAR(drag.value[0], 1.2e-4, std::max(5.0 * drag.sigma[0], 0.01 * 1.2e-4));
}

// As counts of an encoder, written with seven digits.
Channel counted(std::vector<double> angle_rad, int counts_a_turn) {
  for (double& a : angle_rad) {
    const double step = 2.0 * pi / counts_a_turn;
    a = 1e-7 * std::round(1e7 * step * std::round(a / step));
  }
  return {"angle_rad", std::move(angle_rad)};
}

std::string pendulum_toml(double offset_m) {
  return "[platform]\ntopology = \"one_axis\"\naxis = \"x\"\n[[disturbance]]\n"
         "kind = \"static_unbalance\"\noffset_m = { value = [0, 0, " +
         std::to_string(offset_m) + "], sigma = [0, 0.3, 0.5] }\n";
}

void expect_near_truth(const Diagnosis& d, const std::string& kind, const std::string& key,
                       double truth, double part) {
  const FittedParameter& p = parameter(d, kind, key);
  EXPECT_NEAR(p.value[0], truth, std::max(5.0 * p.sigma[0], part * truth)) << kind;
}

// Without friction the model is half a swing ahead after ten periods. In the end it rests, and the
// encoder repeats one count.
TEST(Machines, APendulumThatComesToRestIsFollowedBySwingAndCount) {
  const Channel angle = counted(Swing{55.0, 0.9, 0.15, 0.0}.from(1.6, 0.01, 2400), 4096);
  const Diagnosis d = diagnosed(machine(pendulum_toml(-5.6)), 0.01, {angle});
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d), UnorderedElementsAre("dry_friction", "bearing_drag"));
  expect_near_truth(d, "dry_friction", "torque_N_m", 0.9, 0.01);
  expect_near_truth(d, "bearing_drag", "coefficient_N_m_s", 0.15, 0.02);
}

// Swings whose period depends on their size, with no weight and no friction in the experiment.
TEST(Machines, LargeSwingsAreNamedByWeightAndDrag) {
  const Channel angle = counted(Swing{30.0, 0.0, 0.0, 0.012}.from(2.3, 0.01, 2500), 4096);
  const Diagnosis d =
      diagnosed(machine("[platform]\ntopology = \"one_axis\"\naxis = \"x\"\n"), 0.01, {angle});
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d), UnorderedElementsAre("static_unbalance", "air_pressure_drag"));
  expect_near_truth(d, "air_pressure_drag", "coefficient_N_m_s2", 0.012, 0.02);
  EXPECT_NEAR(parameter(d, "static_unbalance", "offset_m").value[2], -30.0 / standard_gravity_m_s2,
              1e-3);
}

// A wheel with a heavy spot that coasts down about a level axis through fifteen turns. Only rates
// are recorded: central differences of a finer motion.
TEST(Machines, AHeavySpotIsNamedByTheRateAlone) {
  constexpr double weight = 0.926, dry = 0.2, drag = 0.05, fine_s = 0.01;
  const std::vector<double> angle_rad = Swing{weight, dry, drag, 0.0}.from(0.5, fine_s, 1202, 12.0);
  std::vector<double> rate_rad_s;
  for (size_t i = 1; i + 1 < angle_rad.size(); i += 4) {
    rate_rad_s.push_back((angle_rad[i + 1] - angle_rad[i - 1]) / (2.0 * fine_s));
  }
  const Channel rate = noisy("rate_rad_s", rate_rad_s, 0.02, 4);
  const Diagnosis d = diagnosed(machine("[platform]\ntopology = \"one_axis\"\naxis = \"x\"\n"),
                                4.0 * fine_s, {rate});
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d),
              UnorderedElementsAre("static_unbalance", "dry_friction", "bearing_drag"));
  expect_near_truth(d, "dry_friction", "torque_N_m", dry, 0.0);
  expect_near_truth(d, "bearing_drag", "coefficient_N_m_s", drag, 0.0);
  EXPECT_NEAR(parameter(d, "static_unbalance", "offset_m").value[2],
              -weight / standard_gravity_m_s2, 0.006);
}

// Small swings by their closed form, θ = A e^(−c t/2) cos ω t. A drag that depends on a heading
// that never changes is no rival of a drag.
TEST(Machines, ADragHasNoRivalsInAHeadingThatNeverChanges) {
  constexpr double k = 8.0, c = 0.05, noise_rad = 0.003;
  const Channel angle = noisy(
      "angle_rad",
      sampled(1.0 / 30.0, 1200,
              [](double t) { return 0.05 * std::exp(-0.5 * c * t) * std::cos(std::sqrt(k) * t); }),
      noise_rad, 29);
  const Diagnosis d =
      diagnosed(machine(pendulum_toml(-k / standard_gravity_m_s2)), 1.0 / 30.0, {angle});
  ASSERT_THAT(kinds_of(d), ElementsAre("bearing_drag")) << d.sentence;
  EXPECT_GT(d.confidence, 0.7);
  expect_near_truth(d, "bearing_drag", "coefficient_N_m_s", c, 0.0);
}

// The scatter of moving channels, not of resting ones, and no less than the step.
TEST(Machines, AnEncoderAtRestDoesNotDetermineItsNoise) {
  Platform axle;
  axle.topology = Topology::one_axis;
  constexpr int counts = 4096;
  const Channel angle = counted(Swing{55.0, 0.9, 0.15, 0.0}.from(1.6, 0.01, 6000), counts);
  const Segments cut = observe_segments(recording_of(0.01, {angle}), "swing.csv", axle);
  // About z. Rounding is uniform: step/√12.
  const double rounding = 2.0 * pi / counts / std::sqrt(12.0);
  ASSERT_TRUE(reading_level(cut.all, 2));
  EXPECT_GT(*reading_level(cut.all, 2), 0.9 * rounding);
  EXPECT_LT(*reading_level(cut.all, 2), 2.0 * rounding);
}

TEST(Machines, ReadingsDetermineTheirNoise) {
  Noise noise(11, 0.02);
  Channel rate{"gyro_z_rad_s", {}}, steps{"gyro_y_rad_s", {}};
  for (int i = 0; i < 2000; ++i) {
    rate.values.push_back(3.0 * std::sin(0.01 * i) + noise());
    steps.values.push_back(0.5 * std::round(0.004 * i));
  }
  const std::vector<Observation> runs = {
      observe(recording_of(0.1, {rate, steps}), "run.csv", {}, 5000)};
  // The median of |third differences| of n numbers scatters by about 1.4/√n, as second ones do.
  EXPECT_NEAR(*reading_level(runs, 5), 0.02, 4.0 * 0.02 * 1.4 / std::sqrt(2000.0));
  EXPECT_NEAR(*reading_level(runs, 4), 0.5 / std::sqrt(12.0), 1e-12);
  EXPECT_FALSE(reading_level(runs, 3));
  // Equal steps, as of a simulated steady turn, are no last digit.
  const Channel steady{"gyro_x_rad_s", sampled(0.1, 200, [](double t) { return 0.1 * t; })};
  const std::vector<Observation> turn = {
      observe(recording_of(0.1, {steady}), "turn.csv", {}, 5000)};
  EXPECT_LT(reading_level(turn, 3).value_or(0.0), 1e-4);
}

// A motion computed without noise counts as read with about twenty bits.
TEST(Machines, ARateWithoutNoiseHasTheNoiseOfTwentyBits) {
  const Channel exact{"gyro_x_rad_s",
                      sampled(0.1, 2000, [](double t) { return 0.3 * std::sin(0.02 * pi * t); })};
  const std::vector<Observation> runs = {
      observe(recording_of(0.1, {exact}), "exact.csv", {}, 5000)};
  KinematicRun as_read;
  as_read.about_readings = true;
  as_read.axis[0].jumps.assign(runs[0].blocks(), 0);
  const auto level = gyro_level(runs, {as_read}, 0, Thresholds().noise);
  ASSERT_TRUE(level);
  const double rms = 0.3 / std::sqrt(2.0);
  EXPECT_NEAR(level->level, 1e-6 * rms, 1e-3 * 1e-6 * rms);
}

// Motion that the rows follow coarsely, one row in three missing: twenty readings a period.
TEST(Machines, ReadingsDetermineTheirNoiseInFastMotionAndWithMissingRows) {
  Noise noise(12, 0.003);
  Channel rate{"gyro_z_rad_s", {}};
  Recording recording;
  for (int i = 0; i < 3000; ++i) {
    if (i % 3 == 0) continue;
    recording.time_s.push_back(0.01 * i);
    rate.values.push_back(3.0 * std::sin(2.0 * pi * 0.01 * i / 0.3) + noise());
  }
  recording.channels = {rate};
  recording.report.rows_read = recording.report.rows_kept =
      static_cast<int64_t>(recording.time_s.size());
  recording.report.median_interval_s = 0.01;
  const std::vector<Observation> runs = {observe(recording, "run.csv", {}, 5000)};
  // Third differences see 0.018 rad/s, those of rows taken for even ones 0.23 (computed beside this
  // program, in Python); the fourth ones 0.0038.
  EXPECT_NEAR(*reading_level(runs, 5), 0.003, 1.2e-3);
}

TEST(Machines, ResidualsCountAsCorrelatedNoise) {
  // White noise of 1 and a process of 2 that is correlated over 5 s.
  constexpr double time_s = 5.0, interval_s = 0.1;
  Noise normal(13);
  Observation seen;
  Prediction left;
  const double keep = std::exp(-interval_s / time_s);
  double slow = 0.0;
  for (int i = 0; i < 60000; ++i) {
    slow = keep * slow + 2.0 * std::sqrt(1.0 - keep * keep) * normal();
    WhiteRow row = WhiteRow::Constant(NAN);
    row[5] = slow + normal();
    left.off.push_back(row);
    seen.time_s.push_back(interval_s * i);
    seen.gyro_rows.emplace_back(0.0, 0.0, 1.0);
  }
  NoiseLevels own;
  own.set_levels(3, Vec3::Constant(0.5));
  const NoiseLevels noise = with_discrepancy({left}, {seen}, own, Remainder::correlated);
  // 60000 readings hold about 600 independent numbers: 4 % of the variance, 8 % of the time.
  EXPECT_NEAR(noise.of(5).level, std::sqrt(5.0), 0.15 * std::sqrt(5.0));
  EXPECT_NEAR(noise.of(5).coloured, 0.8, 0.05);
  EXPECT_NEAR(noise.of(5).time_s, time_s, 0.35 * time_s);
  EXPECT_EQ(noise.of(3).level, 0.5);
  EXPECT_FALSE(is_quieter(noise, noise));
  EXPECT_TRUE(is_quieter(own, noise));
}

// Independent residuals of 1 in means of 25 readings: so many times the noise of one reading, or a
// fit would take each mean for five times as exact as it is. In the last quarter they are 3.
TEST(Machines, WhatIsLeftOfMeansCountsAsTheirNoise) {
  Noise normal(17);
  Observation seen;
  Prediction left;
  for (int i = 0; i < 8000; ++i) {
    WhiteRow row = WhiteRow::Constant(NAN);
    row[5] = (i < 6000 ? 1.0 : 3.0) * normal();
    left.off.push_back(row);
    seen.time_s.push_back(0.1 * i);
    seen.gyro_rows.emplace_back(0.0, 0.0, 25.0);
    seen.attitude_rows.push_back(0.0);
  }
  NoiseLevels own;
  own.set_levels(3, Vec3::Constant(0.5));
  std::vector<Observation> runs = {seen};
  // (3 · 1 + 9)/4 = 3.
  for (const Remainder remainder : {Remainder::white, Remainder::correlated}) {
    runs[0].noise = with_discrepancy({left}, runs, own, remainder);
    EXPECT_NEAR(runs[0].noise.of(5).level, 5.0 * std::sqrt(3.0), 0.3);
    set_profiles({left}, 4, runs);
    // Four fifths of the mean square in a part, one fifth of that of all.
    EXPECT_NEAR(runs[0].profile.at(0.0), std::sqrt(0.8 / 3.0 + 0.2), 0.02);
    EXPECT_NEAR(runs[0].profile.at(799.0), std::sqrt(0.8 * 3.0 + 0.2), 0.05);
    Whitening whitening(runs[0], 5, 1);
    double square = 0.0;
    for (size_t i = 0; i < seen.blocks(); ++i) {
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Constant(1, left.off[i][5]);
      whitening.apply(seen.time_s[i], 25.0, row);
      if (i >= 6000) square += row[0] * row[0] / 2000.0;
    }
    EXPECT_NEAR(square, 3.0 / (0.8 * 3.0 + 0.2), 0.15);
  }
}

// A wheel that speeds up as if its drag were −5e-4 N m s, which no experiment can state.
TEST(Machines, FittedPriorsStayWithinTheRangeOfTheirKeys) {
  const Channel rate = rate_of_wheel(3, [](double t) { return 3.0 * std::exp(5e-4 * t); });
  const Diagnosis d = diagnosed(machine(wheel_toml), 0.25, {rate});
  ASSERT_EQ(d.priors_refined.size(), 1u) << d.sentence;
  EXPECT_EQ(d.priors_refined[0].key, "disturbance[0].coefficient_N_m_s");
  EXPECT_EQ(d.priors_refined[0].value[0], 0.0) << d.sentence;
}

}  // namespace
}  // namespace photorque
