// A first experiment from the columns and readings of a recording alone, and recordings that cannot
// be of one body.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include "attitude/estimation/conventions.h"
#include "attitude/estimation/free_inertia.h"
#include "attitude/propagation/run.h"
#include "attitude/propagation/sampling.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "diagnosis/attitude/diagnose.h"
#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/guess/guess.h"
#include "scenes/experiment/toml.h"
#include "tests/diagnosis/machine_bench.h"
#include "tests/diagnosis/named.h"
#include "tests/files.h"
#include "tests/noise.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

Settings settings_in(const std::string& toml) {
  return Settings(parse_toml(toml, "guess.toml"));
}

// The rates of a body that turns freely, a wheel on its z axis spinning up at `wheel_rad_s2`.
Recording thrown(const Mat3& inertia_kg_m2, const Vec3& rate_rad_s, double noise_rad_s,
                 uint64_t seed, double wheel_kg_m2 = 0.0, double wheel_rad_s2 = 0.0) {
  constexpr double interval_s = 0.005;
  constexpr int rows = 400;
  AttitudeModel model;
  model.platform.topology = Topology::free;
  model.platform.inertia_kg_m2 = inertia_kg_m2;
  model.environment.gravity_lab_m_s2 = Vec3::Zero();
  if (wheel_kg_m2 > 0.0) {
    const NominalModel with_wheel = machine(
        "[platform]\ntopology = \"free\"\ninertia_kg_m2 = [[1,0,0],[0,1,0],[0,0,1]]\n"
        "[[disturbance]]\nkind = \"wheel_momentum\"\ninertia_kg_m2 = " +
        std::to_string(wheel_kg_m2) + "\n");
    model.disturbances = with_wheel.model.disturbances;
    ZeroOrderHold held;
    held.wheel.acceleration_rad_s2 = {0.0, 0.0, wheel_rad_s2};
    model.schedule.append(-1.0, held);
    model.schedule.held.front().wheel.from_s = 0.0;
  }
  const Dynamics dynamics(model);
  PropagationOptions options;
  options.tolerance = 1e-11;
  Propagator propagator(dynamics, dynamics.initial_state(rate_rad_s), interval_s * rows, options);
  Recording recording;
  recording.channels = {{"gyro_x_rad_s", {}}, {"gyro_y_rad_s", {}}, {"gyro_z_rad_s", {}}};
  if (wheel_kg_m2 > 0.0) recording.channels.push_back({"wheel_z_rad_s", {}});
  Noise normal(seed);
  sample(
      propagator, rows, [&](size_t i) { return interval_s * static_cast<double>(i); },
      [&](const Samples& samples) {
        for (int lane = 0; lane < samples.count; ++lane) {
          const double time_s = samples.time_s[lane];
          recording.time_s.push_back(time_s);
          for (size_t k = 0; k < 3; ++k) {
            recording.channels[k].values.push_back(samples.y[component::rate + k][lane] +
                                                   noise_rad_s * normal());
          }
          if (wheel_kg_m2 > 0.0) recording.channels[3].values.push_back(wheel_rad_s2 * time_s);
        }
      });
  recording.report.rows_read = recording.report.rows_kept = rows;
  recording.report.median_interval_s = interval_s;
  return recording;
}

Platform free_platform() {
  Platform platform;
  platform.topology = Topology::free;
  return platform;
}

InertiaNumbers relative(const Mat3& inertia) {
  InertiaNumbers six;
  six << inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2);
  return 3.0 * six / inertia.trace();
}

const Mat3 racquet = (Mat3() << 1.0, 0.02, 0.0, 0.02, 0.08, -0.01, 0.0, -0.01, 1.07).finished();
const Mat3 board = (Mat3() << 1.0, 0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 1.2).finished();

TEST(Guess, MomentsFollowFromFreeRatesUpToTheirScale) {
  for (const bool wheel : {false, true}) {
    const Recording exact =
        thrown(racquet, {4.0, 2.0, 3.0}, 0.0, 1, wheel ? 2e-3 : 0.0, wheel ? 900.0 : 0.0);
    const auto found = free_inertia({observe(exact, "exact.csv", free_platform())});
    ASSERT_TRUE(found);
    // Integrals by a rule of fourth order: (5 ms × some 10 rad/s)⁴ / 720.
    EXPECT_LT((found->value - relative(racquet)).cwiseAbs().maxCoeff(), 2e-5) << wheel;
    EXPECT_LT(found->left, 1e-4);
  }
}

TEST(Guess, MomentsHaveTheErrorsOfTheirScatter) {
  const InertiaNumbers truth = relative(racquet);
  InertiaNumbers squares = InertiaNumbers::Zero();
  constexpr int draws = 40;
  for (uint64_t seed = 0; seed < draws; ++seed) {
    const auto found = free_inertia(
        {observe(thrown(racquet, {4.0, 2.0, 3.0}, 0.01, seed), "noisy.csv", free_platform())});
    ASSERT_TRUE(found);
    for (int k = 0; k < 6; ++k) {
      squares[k] += std::pow((found->value[k] - truth[k]) / found->sigma(k), 2.0) / draws;
    }
  }
  // Errors may be too wide by the correlation that is assumed, hardly too narrow.
  EXPECT_LT(squares.maxCoeff(), 2.0) << squares.transpose();
  EXPECT_GT(squares.minCoeff(), 0.05) << squares.transpose();
}

TEST(Guess, RatesAboutOneAxisDetermineNoMoments) {
  const auto found =
      free_inertia({observe(thrown(board, {0.0, 0.0, 3.0}, 0.0, 1), "spin.csv", free_platform())});
  EXPECT_FALSE(found);
}

// Swapped, reversed or in degrees, the rates of a thrown body follow no inertia; where the stated
// one is only a guess only the wheel distinguishes it from a mirror image.
TEST(Guess, RatesThatFollowNoInertiaAreReinterpreted) {
  const Recording recording = thrown(racquet, {4.0, 2.0, 3.0}, 0.003, 5, 2e-3, 900.0);
  const Mat3 guessed = Mat3::Identity();
  const auto repaired = [&](const std::function<void(Recording&)>& spoil) {
    Recording spoilt = recording;
    spoil(spoilt);
    Observation seen = observe(spoilt, "throw.csv", free_platform());
    const std::string text = repair_free_rates({&seen, 1}, guessed);
    const auto found = free_inertia({seen}, FreeDrag::none);
    EXPECT_TRUE(found && found->left < 0.02 && found->wheel.z() > 0.0) << text;
    return text;
  };
  const auto times = [](size_t channel, double factor) {
    return [=](Recording& r) {
      for (double& x : r.channels[channel].values) x *= factor;
    };
  };
  EXPECT_EQ(repaired([](Recording&) {}), "");
  EXPECT_THAT(repaired(times(1, -1.0)), HasSubstr("the gyro's axes x, y, z are"));
  EXPECT_THAT(repaired([](Recording& r) { std::swap(r.channels[0].values, r.channels[2].values); }),
              HasSubstr("the gyro's axes x, y, z are"));
  EXPECT_THAT(repaired([&](Recording& r) {
                for (size_t k = 0; k < 3; ++k) times(k, 1.0 / degree_rad)(r);
              }),
              HasSubstr("the gyro reads degrees per second"));
  EXPECT_THAT(repaired(times(3, -1.0)), HasSubstr("the sign of wheel_z_rad_s was reversed"));
}

std::vector<NamedRecording> throws_of(const std::vector<std::pair<std::string, Mat3>>& bodies) {
  std::vector<NamedRecording> all;
  uint64_t seed = 1;
  for (const auto& [name, inertia] : bodies) {
    const Vec3 rate(4.0 + 0.3 * static_cast<double>(seed), 2.0, 3.0);
    all.push_back({name, thrown(inertia, rate, 0.003, seed)});
    ++seed;
  }
  return all;
}

const char* const free_toml = R"([platform]
topology = "free"
[platform.inertia_kg_m2]
value = [[1, 0, 0], [0, 0.4, 0], [0, 0, 1.2]]
sigma = [[0, 0.1, 0.1], [0.1, 0.2, 0.1], [0.1, 0.1, 0.2]]
)";

TEST(Guess, RecordingsOfTwoBodiesAreDistinguished) {
  const Diagnosis d =
      diagnose(machine(free_toml),
               throws_of({{"one.csv", board}, {"two.csv", racquet}, {"three.csv", board}}), {});
  ASSERT_THAT(d.bodies, SizeIs(2));
  EXPECT_THAT(d.bodies[0].recordings, ElementsAre("one.csv", "three.csv"));
  EXPECT_THAT(d.bodies[1].recordings, ElementsAre("two.csv"));
  const InertiaNumbers truth = relative(racquet);
  for (size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(d.bodies[1].inertia_relative[k], truth[static_cast<Eigen::Index>(k)],
                5.0 * d.bodies[1].inertia_relative_sigma[k]);
  }
  EXPECT_THAT(d.warnings.front(), AllOf(HasSubstr("different bodies"), HasSubstr("two.csv: Ixx"),
                                        HasSubstr("one.csv, three.csv: Ixx")));
  EXPECT_THAT(d.sentence, HasSubstr("The recordings are of 2 different bodies."));
}

TEST(Guess, RecordingsOfOneBodyAreNot) {
  const Diagnosis d =
      diagnose(machine(free_toml), throws_of({{"one.csv", board}, {"two.csv", board}}), {});
  EXPECT_TRUE(d.bodies.empty());
  for (const std::string& warning : d.warnings) EXPECT_THAT(warning, Not(HasSubstr("bodies")));
}

TEST(Guess, AClockThatContradictsTheRatesIsReported) {
  std::vector<NamedRecording> runs = throws_of({{"one.csv", board}});
  for (const double factor : {1.0, 1.2}) {
    for (double& time_s : runs.front().recording.time_s) time_s *= factor;
    const Diagnosis d = diagnose(machine(free_toml), runs, {});
    if (factor == 1.0) {
      EXPECT_TRUE(d.instruments.empty());
      continue;
    }
    ASSERT_THAT(d.instruments, SizeIs(1));
    EXPECT_EQ(d.instruments.front().what, "clock_factor");
    EXPECT_NEAR(d.instruments.front().value, 1.0 / factor, 0.01);
  }
}

TEST(Guess, ASensorWithAnotherMountingIsReported) {
  const Mat3 turn = Eigen::AngleAxisd(0.5, Vec3::UnitX()).toRotationMatrix();
  const Diagnosis d =
      diagnose(machine(free_toml),
               throws_of({{"one.csv", board}, {"two.csv", turn * board * turn.transpose()}}), {});
  ASSERT_THAT(d.bodies, SizeIs(2));
  EXPECT_THAT(d.warnings.front(), HasSubstr("their principal moments agree"));
}

std::string angles_text(const std::vector<double>& angle_rad, double interval_s) {
  std::string text = "t_s,angle_rad\n";
  for (size_t i = 0; i < angle_rad.size(); ++i) {
    text += std::to_string(interval_s * static_cast<double>(i)) + "," +
            std::to_string(angle_rad[i]) + "\n";
  }
  return text;
}

// Small oscillations, and large ones with 60 and with 12 readings per period.
TEST(Guess, APendulumHangsFromAHorizontalAxis) {
  const Swing pendulum{10.0, 0.0, 0.05, 0.02};
  for (const auto& [angle_rad, interval_s] : {std::pair(0.2, 0.05), {1.5, 0.035}, {1.5, 0.18}}) {
    const fs::path file = test_file(
        "pendulum.csv", angles_text(pendulum.from(angle_rad, interval_s, 400), interval_s));
    EXPECT_THAT(guess_experiment({file}, "."),
                AllOf(HasSubstr("axis = \"x\""), HasSubstr("CONFIRM")))
        << angle_rad << " rad, every " << interval_s << " s";
  }
}

// A coil drives a pendulum at twelve readings a period: its swing keeps its size, then it decays.
TEST(Guess, ADrivenPendulumIsNoSpring) {
  const Swing pendulum{108.0, 0.0, 0.0, 0.0}, braked{108.0, 0.0, 0.26, 0.0};
  std::vector<double> angle_rad = pendulum.from(1.16, 0.05, 110);
  const std::vector<double> free = braked.from(1.16, 0.05, 240);
  angle_rad.insert(angle_rad.end(), free.begin(), free.end());
  for (double& a : angle_rad) a = 2.0 * pi / 2400.0 * std::round(a * 2400.0 / (2.0 * pi));
  EXPECT_THAT(guess_experiment({test_file("driven.csv", angles_text(angle_rad, 0.05))}, "."),
              HasSubstr("axis = \"x\""));
}

// A bob in a video, y downwards in the picture as a camera counts it; and about which point it
// turns is read back.
TEST(Guess, AVideoOfAPendulumShowsItsPivot) {
  constexpr double length_m = 0.62, pivot_x_m = 0.31, pivot_y_m = -0.05, interval_s = 1.0 / 30.0;
  const std::vector<double> angle_rad = Swing{15.8, 0.0, 0.06, 0.0}.from(0.5, interval_s, 400);
  Noise noise(9, 5e-4);
  std::string text = "t\tx\ty\n";
  for (size_t i = 0; i < angle_rad.size(); ++i) {
    text += printed("%.5f\t%.5f\t%.5f\n", interval_s * static_cast<double>(i),
                    pivot_x_m + length_m * std::sin(angle_rad[i]) + noise(),
                    pivot_y_m + length_m * std::cos(angle_rad[i]) + noise());
  }
  const fs::path file = test_file("video.txt", text);
  const std::string toml = guess_experiment({file}, ".");
  EXPECT_THAT(toml, AllOf(HasSubstr("topology = \"one_axis\""), HasSubstr("axis = \"x\"")));
  const RecordingOptions options = read_recording_options(settings_in(toml).table("recording"));
  ASSERT_TRUE(options.pivot_m);
  EXPECT_NEAR((*options.pivot_m)[0], pivot_x_m, 0.01);
  EXPECT_NEAR((*options.pivot_m)[1], pivot_y_m, 0.01);
  const Recording recording = read_recording(file, options);
  EXPECT_EQ(recording.find("x_m"), nullptr);
  const Channel* angle = recording.find("angle_rad");
  ASSERT_NE(angle, nullptr);
  for (size_t i = 0; i < angle_rad.size(); ++i) {
    EXPECT_NEAR(angle->values[i], angle_rad[i], 0.02) << i;
  }
}

// A short arc in noise, with one wrong place.
TEST(Guess, AShortArcHasItsRadius) {
  constexpr double radius_m = 1.2, interval_s = 1.0 / 30.0;
  Noise noise(14, 0.002 * radius_m);
  double mean_y_m = 0.0;
  constexpr int draws = 20;
  for (int draw = 0; draw < draws; ++draw) {
    std::string text = "t_s,x_m,y_m\n";
    for (int i = 0; i < 400; ++i) {
      const double t = interval_s * i, angle_rad = 0.25 * std::exp(-0.02 * t) * std::cos(2.8 * t);
      text += printed("%.5f,%.5f,%.5f\n", t, radius_m * std::sin(angle_rad) + noise(),
                      -radius_m * std::cos(angle_rad) + noise() + (i == 7 ? 0.8 : 0.0));
    }
    const std::string toml = guess_experiment({test_file("arc.csv", text)}, ".");
    const auto pivot_m = read_recording_options(settings_in(toml).table("recording")).pivot_m;
    ASSERT_TRUE(pivot_m);
    mean_y_m += (*pivot_m)[1] / draws;
  }
  // The radius of one draw scatters by 1.2 % (from random draws).
  EXPECT_NEAR(mean_y_m, 0.0, 0.01 * radius_m);
}

// A straight track is part of any large circle.
TEST(Guess, ATrackIsNoCircle) {
  Noise noise(10, 1e-3);
  std::string text = "t_s,x_m,y_m\n";
  for (int i = 0; i < 300; ++i) {
    const double along = 0.4 * std::cos(0.2 * i);
    text += printed("%.2f,%.4f,%.4f\n", 0.05 * i, along + noise(), 0.1 * along + noise());
  }
  const std::string toml = guess_experiment({test_file("track.csv", text)}, ".");
  EXPECT_THAT(toml, AllOf(HasSubstr("topology = \"planar\""), Not(HasSubstr("pivot_m"))));
}

TEST(Guess, OneCoordinateOrASpeedIsAlongALine) {
  std::string
      cart =
          "Data Set 1:Time(s),Data Set 1:Position(m),Data Set 1:Velocity(m/s),Acceleration(m/s²)\n",
      car = "time (s);speed (km/h)\n";
  for (int i = 0; i < 60; ++i) {
    cart += printed("%.3f,%.4f,%.4f,0\n", 0.033 * i, 0.3 + 0.1 * std::cos(0.2 * i),
                    -0.6 * std::sin(0.2 * i));
    car += printed("%d;%.2f\n", i, 50.0 - 0.5 * i);
  }
  EXPECT_THAT(
      guess_experiment({test_file("cart.csv", cart)}, "."),
      AllOf(HasSubstr("topology = \"planar\""), HasSubstr("x_m = \"Data Set 1:Position(m)\""),
            Not(HasSubstr("velocity_x_m_s ="))));
  EXPECT_THAT(
      guess_experiment({test_file("car.csv", car)}, "."),
      AllOf(HasSubstr("topology = \"planar\""), HasSubstr("velocity_x_km_h = \"speed (km/h)\"")));
}

// The guess of this file has one effect: a spring of this stiffness, to a part of it.
void expect_spring(const fs::path& file, double stiffness, double part) {
  const Settings guessed = settings_in(guess_experiment({file}, "."));
  const std::vector<Settings> effects = guessed.tables("disturbance");
  ASSERT_EQ(effects.size(), 1U);
  EXPECT_EQ(effects[0].text("kind"), "sliding_spring");
  EXPECT_NEAR(effects[0].table("stiffness_N_per_m").number("value"), stiffness, part * stiffness);
}

// x = x₀ + a e^(−γt) cos ωt has the stiffness ω² + γ² for a unit mass. A body between cushions has
// no spring.
TEST(Guess, AWeightThatOscillatesHangsOnASpring) {
  constexpr double omega_rad_s = 6.1, damping_1_s = 0.03, middle_m = 0.14;
  Noise noise(12, 1e-3);
  std::string spring = "t,x\n", cushions = spring, brief;
  for (int i = 0; i < 500; ++i) {
    if (i == 72) brief = spring;  // 2.3 periods far above the noise
    const double t = i / 30.0, phase = std::remainder(0.16 * t, 1.0);
    const double x = 0.05 * std::exp(-damping_1_s * t) * std::cos(omega_rad_s * t);
    spring += printed("%.4f,%.5f\n", t, middle_m + x + noise());
    cushions += printed("%.4f,%.5f\n", t, std::abs(phase) + noise());
  }
  const double stiffness = omega_rad_s * omega_rad_s + damping_1_s * damping_1_s;
  expect_spring(test_file("spring.csv", spring), stiffness, 0.03);
  EXPECT_THAT(guess_experiment({test_file("brief.csv", brief)}, "."), HasSubstr("sliding_spring"));
  EXPECT_THAT(guess_experiment({test_file("cushions.csv", cushions)}, "."),
              Not(HasSubstr("sliding_spring")));
}

// White noise of 2 mm, and a strongly damped oscillation after which the readings rest in noise.
TEST(Guess, NoiseIsNoSpring) {
  constexpr double omega_rad_s = 0.7, damping_1_s = 0.09;
  Noise noise(13, 2e-3);
  std::string white = "t,x\n", seismometer = white;
  for (int i = 0; i < 900; ++i) {
    const double t = 0.1 * i;
    white += printed("%.1f,%.5f\n", t, noise());
    seismometer += printed("%.1f,%.5f\n", t,
                           0.25 * std::exp(-damping_1_s * t) * std::cos(omega_rad_s * t) + noise());
  }
  EXPECT_THAT(guess_experiment({test_file("white.csv", white)}, "."),
              Not(HasSubstr("sliding_spring")));
  const double stiffness = omega_rad_s * omega_rad_s + damping_1_s * damping_1_s;
  expect_spring(test_file("rests.csv", seismometer), stiffness, 0.1);
}

// A lost frame is eight times as far away as the spring reaches.
TEST(Guess, OneLostFrameDoesNotHideASpring) {
  constexpr double omega_rad_s = 4.0;
  Noise noise(15, 1e-3);
  std::string text = "t,x\n";
  for (int i = 0; i < 600; ++i) {
    const double t = 0.1 * i;
    text += printed("%.1f,%.5f\n", t, i == 40 ? 0.4 : 0.05 * std::cos(omega_rad_s * t) + noise());
  }
  expect_spring(test_file("lost.csv", text), omega_rad_s * omega_rad_s, 0.1);
}

// Counts of an encoder. At 14.5 counts per reading, the rounding errors alternate. Noise of 0.6
// steps before the rounding adds to its variance of a twelfth.
TEST(Guess, AnEncoderHasTheNoiseOfItsStep) {
  constexpr double step_rev = 1e-3, step_rad = step_rev * 2.0 * pi;
  const auto guessed_rad = [&](double noise_steps, uint64_t seed) {
    Noise noise(seed, std::max(noise_steps, 1e-9));
    std::string text = "time (s),angle (revolutions)\n";
    for (int i = 0; i < 600; ++i) {
      const double counts = 14.49 * (i - 12.0 * (1.0 - std::exp(-i / 12.0))) + noise();
      text += printed("%.4f,%.3f\n", 0.01 * i, step_rev * std::round(counts));
    }
    return settings_in(guess_experiment({test_file("encoder.csv", text)}, "."))
        .table("sensors")
        .table("angle")
        .number("noise_arcsec");
  };
  EXPECT_NEAR(guessed_rad(0.0, 1), step_rad / std::sqrt(12.0), 0.003 * step_rad);
  const double noisy = step_rad * std::sqrt(1.0 / 12.0 + 0.6 * 0.6);
  EXPECT_NEAR(guessed_rad(0.6, 2), noisy, 0.15 * noisy);
}

// The turning points of a swing alternate in sign: their differences contain no noise.
TEST(Guess, TurningPointsDetermineNoNoise) {
  std::string text = "t_s,angle_rad\n";
  for (int i = 0; i < 120; ++i) {
    text += printed("%.2f,%.4f\n", 0.68 * i, 0.35 * std::pow(-0.995, i));
  }
  EXPECT_THAT(guess_experiment({test_file("turns.csv", text)}, "."),
              Not(HasSubstr("noise_arcsec =")));
}

// θ'' = −k θ − c θ': a damped cosine, which a hand releases after 0.4 s, with readings of 3 mrad.
TEST(Guess, ATorsionPendulumTurnsAboutAnUprightAxis) {
  constexpr double k = 10.5, c = 0.3, released_s = 0.4, noise_rad = 0.003;
  const double omega = std::sqrt(k - 0.25 * c * c);
  for (const double interval_s : {0.03, 0.1}) {
    Noise noise(5, noise_rad);
    std::vector<double> angle_rad;
    for (int i = 0; i < 300; ++i) {
      const double t = std::max(0.0, interval_s * i - released_s);
      angle_rad.push_back(2.2 * std::exp(-0.5 * c * t) *
                              (std::cos(omega * t) + 0.5 * c / omega * std::sin(omega * t)) +
                          noise());
    }
    const fs::path file = test_file("wheel.csv", angles_text(angle_rad, interval_s));
    EXPECT_THAT(guess_experiment({file}, "."),
                AllOf(HasSubstr("axis = \"z\""), HasSubstr("in proportion to the angle")))
        << "every " << interval_s << " s";
  }
}

// A spring beyond half a turn, and a spring and a pendulum of which three periods were recorded.
TEST(Guess, LargeAndShortSwingsShowTheirLaw) {
  const auto guess = [](const std::vector<double>& angle_rad) {
    return guess_experiment({test_file("swing.csv", angles_text(angle_rad, 0.05))}, ".");
  };
  for (const double most_rad : {4.2, 2.6}) {
    std::vector<double> angle_rad;
    for (int i = 0; i < 90; ++i) {
      const double t = 0.05 * i;
      angle_rad.push_back(0.1 + most_rad * std::exp(-0.1 * t) * std::cos(4.5 * t));
    }
    EXPECT_THAT(guess(angle_rad), HasSubstr("axis = \"z\"")) << most_rad;
  }
  EXPECT_THAT(guess(Swing{25.0, 0.0, 0.2, 0.0}.from(2.6, 0.05, 90)), HasSubstr("axis = \"x\""));
}

// Three rates of a telephone on a pendulum: those across the axis are smaller, and none has a mean.
TEST(Guess, APendulumIsNoFreeBodyByItsRates) {
  constexpr double omega = 3.1, c = 0.05;
  for (const double across : {0.06, 0.3}) {
    Noise noise(6, 0.004);
    std::string text = "Time (s),Gyroscope x (rad/s),Gyroscope y (rad/s),Gyroscope z (rad/s)\n";
    for (int i = 0; i < 1500; ++i) {
      const double t = 0.02 * i,
                   rate_rad_s = 0.6 * std::exp(-0.5 * c * t) * std::sin(omega * t + 0.7);
      text += printed("%.9g,%.9g,%.9g,%.9g\n", t, across * rate_rad_s + noise(),
                      -across * rate_rad_s + noise(), rate_rad_s + 0.002 + noise());
    }
    EXPECT_THAT(guess_experiment({test_file("phone.csv", text)}, "."),
                AllOf(HasSubstr("topology = \"one_axis\""), HasSubstr("axis = \"x\""),
                      HasSubstr("rate_rad_s = \"Gyroscope z (rad/s)\"")))
        << across;
  }
}

// Independent oscillations about three axes follow no tensor of inertia: it is guessed.
TEST(Guess, RatesThatFollowNoInertiaGiveNoRatios) {
  std::string text = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
  for (int i = 0; i < 600; ++i) {
    const double t = 0.05 * i;
    text += printed("%.2f,%.4f,%.4f,%.4f\n", t, 2.0 * std::sin(1.1 * t), 2.0 * std::cos(1.3 * t),
                    2.0 + std::sin(0.3 * t));
  }
  const std::string toml = guess_experiment({test_file("driven.csv", text)}, ".");
  EXPECT_THAT(toml, HasSubstr("do not determine the ratios"));
  EXPECT_TRUE(machine(toml).model.platform.inertia_kg_m2.isApprox(Mat3::Identity()));
  // A proposed alternative is complete.
  EXPECT_THAT(toml, HasSubstr("it is \"tabletop\", which requires mass_kg."));
  std::string on_bearing = toml;
  on_bearing.replace(on_bearing.find("topology = \"free\""), 17,
                     "topology = \"tabletop\"\nmass_kg = 1");
  EXPECT_EQ(machine(on_bearing).model.platform.topology, Topology::tabletop);
}

TEST(Guess, AThrowHasTheRatiosOfItsMoments) {
  const fs::path file = fs::path(testing::TempDir()) / "throw.csv";
  write_recording(file, thrown(board, {4.0, 2.0, 3.0}, 0.003, 7));
  const std::string toml = guess_experiment({file}, ".");
  EXPECT_THAT(toml, HasSubstr("topology = \"free\""));
  const NominalModel model = machine(toml);
  EXPECT_NEAR(model.model.platform.inertia_kg_m2(1, 1), 0.4, 0.01);
  EXPECT_NEAR(model.model.platform.inertia_kg_m2(2, 2), 1.2, 0.02);
  EXPECT_TRUE(model.uncertain_inertia);
  ASSERT_TRUE(model.sensors.gyro);
  EXPECT_NEAR(model.sensors.gyro->noise_rad_s, 0.003, 0.0006);
}

// Dry friction 0.1 and viscous drag 0.67 stop a body of inertia 1 after 3.04 s; the gyro then reads
// its bias of -0.03. The law of motion until then is v(t) = (1 + 0.1/0.67) exp(-0.67 t) - 0.1/0.67.
TEST(Guess, AGyroThatReadsARateAtRestHasABias) {
  constexpr double dry = 0.1, viscous = 0.67, bias_rad_s = -0.03;
  const auto guessed_with = [&](double noise_rad_s, double end_s) {
    Noise noise(17, noise_rad_s);
    std::string text = "t_s,rate_rad_s\n";
    for (int i = 0; 0.05 * i < end_s; ++i) {
      const double t = 0.05 * i, v = (1.0 + dry / viscous) * std::exp(-viscous * t) - dry / viscous;
      text += printed("%.2f,%.5f\n", t, std::max(v, 0.0) + bias_rad_s + noise());
    }
    return guess_experiment({new_file(text, ".csv")}, ".");
  };
  const Settings gyro =
      settings_in(guessed_with(7e-4, 4.0)).table("sensors").table("gyro").table("bias_rad_s");
  EXPECT_NEAR(gyro.vector3("value").z(), bias_rad_s, 1e-3);
  // It still turns at the end.
  EXPECT_THAT(guessed_with(7e-4, 2.0), Not(HasSubstr("bias_rad_s")));
}

// One row per turn, beside columns that are no motion: the turns are read as rates.
TEST(Guess, UnusedColumnsDoNotHideTheTurnsOfAWheel) {
  std::string text = "t_s,c2,angle_rev,c4\n";
  for (int i = 0; i < 120; ++i) {
    // 10 rev/s that fall by 0.05 rev/s²: the time of the i-th turn.
    const double t = (10.0 - std::sqrt(100.0 - 0.1 * i)) / 0.05;
    text += printed("%.6f,%d,%d,4.99\n", t, 15 - i % 2, 3403 + i);
  }
  const std::string guessed = guess_experiment({new_file(text, ".csv")}, ".");
  EXPECT_THAT(guessed, Not(HasSubstr("pendulum")));
  EXPECT_EQ(settings_in(guessed).table("platform").text("axis"), "z");
}

}  // namespace
}  // namespace photorque
