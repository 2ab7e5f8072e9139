// Machines of a textbook as people record them: a hand at the start, few readings a period, noise
// of a hundredth. Motions by closed form or by the Runge-Kutta rule of machine_bench.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "attitude/estimation/segments.h"
#include "core/constants.h"
#include "tests/diagnosis/machine_bench.h"
#include "tests/noise.h"

namespace photorque {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

std::string about(const std::string& axis, const std::string& noise) {
  return "[platform]\ntopology = \"one_axis\"\naxis = \"" + axis + "\"\n[sensors." + noise + "\n";
}

std::vector<double> rounded(std::vector<double> values, double step) {
  for (double& value : values) value = step * std::round(value / step);
  return values;
}

void expect_number(const Diagnosis& d, const std::string& kind, const std::string& key,
                   size_t component, double truth) {
  const FittedParameter& p = parameter(d, kind, key);
  EXPECT_NEAR(p.value[component], truth, 5.0 * p.sigma[component]) << kind << ": " << d.sentence;
  EXPECT_LT(p.sigma[component], 0.2 * std::abs(truth)) << kind;
}

// A video of 30 frames a second; a hand moves the pendulum outwards until it lets go after 0.25 s.
TEST(TextbookMachines, APendulumHeldByAHandAtFirst) {
  constexpr double k = 14.6, form = 0.0168, frame_s = 0.0338, released_rad = 1.44;
  const Swing pendulum{k, 0.0, 0.0, form};
  for (const int rows : {211, 423}) {
    std::vector<double> angle_rad = {1.15, 1.16, 1.20, 1.28, 1.35, 1.39, 1.43};
    const std::vector<double> free = pendulum.from(released_rad, frame_s, rows - 7);
    angle_rad.insert(angle_rad.end(), free.begin(), free.end());
    const Diagnosis d = diagnosed(machine(about("x", "angle]\nnoise_arcsec = 620")), frame_s,
                                  {noisy("angle_rad", angle_rad, 0.003, 3)});
    EXPECT_THAT(d.warnings, Contains(HasSubstr("a hand holds it"))) << rows << " rows";
    EXPECT_THAT(kinds_of(d), Contains("static_unbalance")) << rows << " rows: " << d.sentence;
    EXPECT_THAT(kinds_of(d),
                testing::AnyOf(Contains("air_pressure_drag"), Contains("air_friction")))
        << rows << " rows: " << d.sentence;
    expect_number(d, "static_unbalance", "offset_m", 2, -k / 9.80665);
  }
}

// A pendulum that swings freely from the first row, with one wrong angle of six times the noise.
TEST(TextbookMachines, AWrongAngleIsNotAHand) {
  constexpr double interval_s = 0.0338, noise_rad = 0.003;
  std::vector<double> angle_rad = Swing{14.6, 0.0, 0.05, 0.0}.from(1.44, interval_s, 300);
  angle_rad[5] += 6.0 * noise_rad;
  const auto notes = [&] {
    return observe_segments(recording_of(interval_s, {noisy("angle_rad", angle_rad, noise_rad, 3)}),
                            "swing.csv",
                            machine(about("x", "angle]\nnoise_arcsec = 620")).model.platform)
        .exclusions;
  };
  EXPECT_THAT(notes(), testing::Each(Not(HasSubstr("a hand holds it"))));
  // A hand that slows it is one.
  std::vector<double> held = {1.15, 1.16, 1.20, 1.28, 1.35, 1.39, 1.43};
  angle_rad.insert(angle_rad.begin(), held.begin(), held.end());
  EXPECT_THAT(notes(), Contains(HasSubstr("a hand holds it")));
}

// θ'' = −k θ − c θ' from 4.2 rad, beyond half a turn, and from −3.7 rad after a gap.
TEST(TextbookMachines, ATorsionPendulumBeyondHalfATurn) {
  constexpr double k = 20.0, c = 0.25, interval_s = 0.05;
  const DampedSwing swing{k, c};
  const auto recorded = [&](double from_rad, uint64_t seed) {
    return NamedRecording{
        "run" + std::to_string(seed) + ".csv",
        recording_of(interval_s, {noisy("angle_rad",
                                        sampled(interval_s, 90,
                                                [&](double t) { return from_rad * swing.at(t); }),
                                        0.004, seed)})};
  };
  const Diagnosis d = diagnose(machine(about("z", "angle]\nnoise_arcsec = 825")),
                               {recorded(4.2, 6), recorded(-3.7, 7)}, {recorded(3.9, 8)});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("tether", "bearing_drag")) << d.sentence;
  expect_number(d, "tether", "stiffness_N_m_per_rad", 0, k);
  expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, c);
  ASSERT_TRUE(d.replay);
  EXPECT_EQ(d.replay->initial_turns, 1.0);
}

// ω' = −d − c ω: θ = (ω₀ + d/c) (1 − e^(−c t))/c − d t/c of a rotor, by an encoder whose scatter is
// larger than stated. It turns so little that a suspension line could be twisted.
TEST(TextbookMachines, ARotorOfFewTurnsBesideAResidual) {
  constexpr double c = 3.4, dry = 1100.0, first_rad_s = 1290.0, interval_s = 5e-4;
  const std::vector<double> angle_rad = sampled(interval_s, 460, [](double t) {
    return (first_rad_s + dry / c) * (1.0 - std::exp(-c * t)) / c - dry * t / c;
  });
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const Diagnosis d = diagnosed(machine(about("z", "angle]\nnoise_arcsec = 5870")), interval_s,
                                  {noisy("angle_rad", angle_rad, 0.04, seed)});
    EXPECT_THAT(kinds_of(d), UnorderedElementsAre("dry_friction", "bearing_drag")) << d.sentence;
    expect_number(d, "dry_friction", "torque_N_m", 0, dry);
  }
}

// ω' = T − c ω from rest: ω = (T/c) (1 − e^(−c t)), with noise of a fiftieth of the final rate.
TEST(TextbookMachines, AFlywheelThatAMotorSpinsUp) {
  constexpr double torque = 208.0, c = 0.76, interval_s = 0.02, noise_rad_s = 4.9;
  constexpr int recordings = 4;
  const std::vector<double> rate_rad_s =
      sampled(interval_s, 196, [](double t) { return torque / c * (1.0 - std::exp(-c * t)); });
  for (uint64_t seed = 6; seed < 6 + recordings; ++seed) {
    const Diagnosis d = diagnosed(machine(about("z", "gyro]\nnoise_rad_s = 4.9")), interval_s,
                                  {noisy("rate_rad_s", rate_rad_s, noise_rad_s, seed)});
    ASSERT_THAT(kinds_of(d), UnorderedElementsAre("bearing_drag", "room_draft")) << d.sentence;
    expect_number(d, "room_draft", "torque_lab_N_m", 2, torque);
    expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, c);
  }
}

// θ'' = −k (θ − θ₀) − c θ', as a program for schools writes it: angles to a hundredth, whose zero
// differs from the rest position by a few digits, and a rate from the unrounded angles before and
// after, which the first row lacks and which is too small by sin(ωh)/(ωh).
TEST(TextbookMachines, ATorsionPendulumWithItsZeroBesideItsRest) {
  constexpr double k = 8.4, c = 0.047, rest_rad = -0.023, interval_s = 0.11;
  const DampedSwing swing{k, c};
  const auto angle_at = [&](double t) { return rest_rad + 2.1 * swing.at(t); };
  const std::vector<double> angle_rad = sampled(interval_s, 240, angle_at);
  const std::vector<double> rate_rad_s = sampled(interval_s, 240, [&](double t) {
    return t == 0.0 ? NAN
                    : 0.5 / interval_s * (angle_at(t + interval_s) - angle_at(t - interval_s));
  });
  const Diagnosis d = diagnosed(
      machine("[platform]\ntopology = \"one_axis\"\n"), interval_s,
      {{"angle_rad", rounded(angle_rad, 0.01)}, {"rate_rad_s", rounded(rate_rad_s, 0.001)}});
  EXPECT_THAT(d.warnings, Contains(HasSubstr("difference of neighbouring angles")));
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("tether", "bearing_drag")) << d.sentence;
  expect_number(d, "tether", "stiffness_N_m_per_rad", 0, k);
  expect_number(d, "tether", "pull_N_m", 0, k * rest_rad);
  expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, c);
}

// x'' = −k (x − x₀) − c x' of a cart between two springs, by the one distance that an ultrasonic
// sensor reads to a millimetre.
TEST(TextbookMachines, ACartOnASpringByOneCoordinate) {
  constexpr double k = 27.0, c = 0.21, rest_m = 0.42, interval_s = 0.06;
  const DampedSwing swing{k, c};
  const std::vector<double> distance_m =
      sampled(interval_s, 260, [&](double t) { return rest_m + 0.11 * swing.at(t); });
  const Diagnosis d = diagnosed(machine("[platform]\ntopology = \"planar\"\n"), interval_s,
                                {noisy("x_m", distance_m, 0.001, 12)});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("sliding_spring", "sliding_drag")) << d.sentence;
  expect_number(d, "sliding_spring", "stiffness_N_per_m", 0, k);
  expect_number(d, "sliding_spring", "pull_N", 0, k * rest_m);
  expect_number(d, "sliding_drag", "coefficient_kg_s", 0, c);
}

// Correlated errors of a camera, of a scale of time [s], as of a lens or a hand: e^(−Δt/scale) of
// each remains at the next reading.
std::vector<double> drifting(double sigma, double scale_s, double interval_s, size_t rows,
                             uint64_t seed) {
  const double kept = std::exp(-interval_s / scale_s);
  Noise fresh(seed, sigma * std::sqrt(1.0 - kept * kept));
  std::vector<double> all = {0.0};
  while (all.size() < rows) all.push_back(kept * all.back() + fresh());
  return all;
}

// Dry and viscous friction together, whose sum neither replaces, beside errors of the readings that
// are far above their scatter. One law alone predicts five times worse.
TEST(TextbookMachines, DryAndViscousFrictionBesideAResidual) {
  constexpr double k = 120.3, dry = 2.3, viscous = 0.19, interval_s = 0.005;
  std::vector<NamedRecording> runs;
  for (uint64_t run = 0; run < 3; ++run) {
    std::vector<double> angle_rad =
        Swing{k, dry, viscous, 0.0}.from(1.3 - 0.1 * static_cast<double>(run), interval_s, 800);
    const std::vector<double> off = drifting(0.01, 0.1, interval_s, angle_rad.size(), 20 + run);
    for (size_t i = 0; i < angle_rad.size(); ++i) angle_rad[i] += off[i];
    runs.push_back({"run" + std::to_string(run) + ".csv",
                    recording_of(interval_s, {noisy("angle_rad", angle_rad, 5e-4, 30 + run)})});
  }
  const Diagnosis d =
      diagnose(machine(about("x", "angle]\nnoise_arcsec = 103")), {runs[0], runs[1]}, {runs[2]});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("static_unbalance", "dry_friction", "bearing_drag"))
      << d.sentence;
  expect_number(d, "dry_friction", "torque_N_m", 0, dry);
  expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, viscous);
}

// Readings six times a period, with a noise of 3 degrees that no file states.
TEST(TextbookMachines, APendulumInSixReadingsAPeriod) {
  constexpr double k = 8.06, viscous = 0.023, interval_s = 0.4167, noise_rad = 0.052;
  const std::vector<double> angle_rad = Swing{k, 0.0, viscous, 0.0}.from(1.4, interval_s, 59);
  const Diagnosis d = diagnosed(machine("[platform]\ntopology = \"one_axis\"\naxis = \"x\"\n"),
                                interval_s, {noisy("angle_rad", angle_rad, noise_rad, 8)});
  EXPECT_THAT(kinds_of(d), Contains("static_unbalance")) << d.sentence;
  expect_number(d, "static_unbalance", "offset_m", 2, -k / 9.80665);
}

// ω' = T − q ω² from a rest of 0.6 s: θ = ln cosh(√(T q) t)/q, by an encoder of 1024 steps.
TEST(TextbookMachines, AFanThatIsSwitchedOn) {
  constexpr double torque = 80.0, form = 0.038, interval_s = 0.01, rest_s = 0.6;
  const std::vector<double> angle_rad = sampled(interval_s, 340, [](double t) {
    return std::log(std::cosh(std::sqrt(torque * form) * std::max(0.0, t - rest_s))) / form;
  });
  const Diagnosis d = diagnosed(machine(about("z", "angle]\nnoise_arcsec = 365")), interval_s,
                                {{"angle_rad", rounded(angle_rad, 2.0 * pi / 1024.0)}});
  EXPECT_THAT(d.warnings, Contains(HasSubstr("the body is at rest and then starts suddenly")));
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("room_draft", "air_pressure_drag")) << d.sentence;
  expect_number(d, "air_pressure_drag", "coefficient_N_m_s2", 0, form);
}

// The motion of a motor from its first row, or of a swing, has no rest that could be left out.
TEST(TextbookMachines, MotionFromTheFirstRowIsNotARest) {
  std::vector<double> run_up, swing;
  for (int i = 0; i < 200; ++i) {
    run_up.push_back(50.0 * (1.0 - std::exp(-0.02 * i)));
    swing.push_back(std::cos(0.1 * i));
  }
  const Platform upright = machine(about("z", "gyro]\nnoise_rad_s = 1")).model.platform;
  const auto notes = [&](const Channel& channel) {
    return observe_segments(recording_of(0.02, {channel}), "run.csv", upright).exclusions;
  };
  EXPECT_THAT(notes(noisy("rate_rad_s", run_up, 0.5, 1)), testing::IsEmpty());
  EXPECT_THAT(notes(noisy("angle_rad", swing, 0.01, 2)), testing::IsEmpty());
}

// θ'' = −k θ − c θ' known by its rate alone, from any instant of the swing, with a bias.
TEST(TextbookMachines, ATorsionPendulumByItsRateAlone) {
  constexpr double k = 5.97, c = 0.0103, interval_s = 0.02;
  const DampedSwing swing{k, c};
  const std::vector<double> rate_rad_s = sampled(
      interval_s, 2500, [&](double t) { return 0.002 + 1.8 * swing.rate(t + 44 * interval_s); });
  const Diagnosis d = diagnosed(machine(about("z", "gyro]\nnoise_rad_s = 0.01")), interval_s,
                                {noisy("gyro_z_rad_s", rate_rad_s, 0.01, 9)});
  EXPECT_THAT(kinds_of(d), testing::IsSupersetOf({"tether", "bearing_drag"})) << d.sentence;
  expect_number(d, "tether", "stiffness_N_m_per_rad", 0, k);
  expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, c);
}

// About a level axis the same readings are those of a weight; small swings are harmonic.
TEST(TextbookMachines, APendulumByItsRateAlone) {
  constexpr double k = 9.1, c = 0.1, interval_s = 0.02, swing_rad = 0.05;
  const DampedSwing swing{k, c};
  const std::vector<double> rate_rad_s = sampled(
      interval_s, 1500, [&](double t) { return swing_rad * swing.rate(t + 20 * interval_s); });
  const Diagnosis d = diagnosed(machine(about("x", "gyro]\nnoise_rad_s = 0.002")), interval_s,
                                {noisy("gyro_x_rad_s", rate_rad_s, 0.002, 10)});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("static_unbalance", "bearing_drag")) << d.sentence;
  expect_number(d, "static_unbalance", "offset_m", 2, -k / 9.80665);
  expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, c);
  EXPECT_THAT(d.sentence, HasSubstr("alone, it swings at 0.48"));  // √9.1 / 2π Hz
  EXPECT_THAT(d.warnings, Contains(HasSubstr("also an angular acceleration in rad/s²")));
}

// An elliptic swing of a telephone, taken for a free body: no effect lowers χ² as it should, so
// that none is named, however much the segments gain.
TEST(TextbookMachines, ASwingTakenForAFreeBodyHasNoName) {
  constexpr double omega = 4.5, interval_s = 0.04, noise_rad_s = 0.01;
  const auto rate = [&](double most_rad_s, double phase, uint64_t seed) {
    return noisy(std::string("gyro_") + "xyz"[seed] + "_rad_s",
                 sampled(interval_s, 200,
                         [&](double t) { return most_rad_s * std::cos(omega * t + phase); }),
                 noise_rad_s, seed);
  };
  const Diagnosis d =
      diagnosed(machine("[platform]\ntopology = \"free\"\n[platform.inertia_kg_m2]\n"
                        "value = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
                        "sigma = [[0, 0.2, 0.2], [0.2, 0.4, 0.2], [0.2, 0.2, 0.4]]\n"
                        "[sensors.gyro]\nnoise_rad_s = 0.01\n"),
                interval_s, {rate(2.0, 0.0, 0), rate(0.0, 0.0, 1), rate(0.6, -1.57, 2)});
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_THAT(kinds_of(d), testing::IsEmpty()) << d.sentence;
  EXPECT_LE(d.chi2_per_sample_after, d.chi2_per_sample_before);
}

// A rate that is computed from the angle adds no information; a rate with independent errors does.
TEST(TextbookMachines, ARateComputedFromTheAngleIsLeftOut) {
  constexpr double k = 21.5, viscous = 0.16, interval_s = 0.01;
  const std::vector<double> angle_rad =
      rounded(Swing{k, 0.0, viscous, 0.0}.from(0.9, interval_s, 1200), 2.0 * pi / 2000.0);
  std::vector<double> rate_rad_s(angle_rad.size());
  for (size_t i = 0; i < angle_rad.size(); ++i) {
    const size_t before = i - std::min<size_t>(i, 1), after = std::min(angle_rad.size() - 1, i + 1);
    rate_rad_s[i] =
        (angle_rad[after] - angle_rad[before]) / (interval_s * static_cast<double>(after - before));
  }
  const NominalModel pendulum = machine(about("x", "angle]\nnoise_arcsec = 200"));
  const Channel angle{"angle_rad", angle_rad}, rate{"rate_rad_s", rate_rad_s};
  const Diagnosis d = diagnosed(pendulum, interval_s, {angle, rate});
  EXPECT_THAT(d.warnings, Contains(HasSubstr("difference of neighbouring angles")));
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("static_unbalance", "bearing_drag")) << d.sentence;
  expect_number(d, "bearing_drag", "coefficient_N_m_s", 0, viscous);
  const Segments read =
      observe_segments(recording_of(interval_s, {angle, noisy("rate_rad_s", rate_rad_s, 0.05, 11)}),
                       "swing.csv", pendulum.model.platform);
  EXPECT_TRUE(read.all.front().has_gyro);
}

// ω' = −a − q ω²: cos(φ₀ − √(a q) t) = cos φ₀ e^(q θ), ω = √(a/q) tan(φ₀ − √(a q) t). A reading
// a turn.
TEST(TextbookMachines, AWheelThatCountsItsTurns) {
  constexpr double dry = 0.47, form = 3e-4, first_rad_s = 90.0;
  const double fast = std::sqrt(dry * form), phase = std::atan(first_rad_s * std::sqrt(form / dry));
  Recording recording = recording_of(1.0, {{"angle_rad", {}}});
  for (int turn = 0;; ++turn) {
    const double angle_rad = 2.0 * pi * turn, cosine = std::cos(phase) * std::exp(form * angle_rad);
    if (!(cosine < 0.999)) break;
    recording.time_s.push_back((phase - std::acos(cosine)) / fast);
    recording.channels[0].values.push_back(angle_rad);
  }
  const Diagnosis d =
      diagnose(machine("[platform]\ntopology = \"one_axis\"\n"), {{"turns.csv", recording}}, {});
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("dry_friction", "air_pressure_drag")) << d.sentence;
  EXPECT_NEAR(parameter(d, "dry_friction", "torque_N_m").value[0], dry, 0.01 * dry);
  EXPECT_NEAR(parameter(d, "air_pressure_drag", "coefficient_N_m_s2").value[0], form, 0.01 * form);
}

}  // namespace
}  // namespace photorque
