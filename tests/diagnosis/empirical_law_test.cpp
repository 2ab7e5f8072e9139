// An unknown law, from the recording to the file that propagates it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "attitude/estimation/fit.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/effects/scan.h"
#include "diagnosis/attitude/findings.h"
#include "diagnosis/improved.h"
#include "scenes/experiment/toml.h"
#include "tests/diagnosis/rigid_body_recording.h"

namespace photorque {
namespace {

using namespace rigid_body;
using testing::HasSubstr;

// The nominal model of the recordings as a user writes it.
const std::string nominal_text = R"([platform]
topology = "tabletop"
mass_kg = 7
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]

[environment]
gravity_m_s2 = 9.80665
magnetic_field_T = [1e-6, 2.2e-5, -4.2e-5]

[[disturbance]]
kind = "static_unbalance"
offset_m = { value = [2.3e-6, -1.2e-6, -3.1e-5], sigma = [1e-6, 1e-6, 1e-6] }

[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = { value = 1.8e-5, sigma = 4e-6 }
)";

struct Fitted {
  std::vector<Observation> runs;
  Candidates all;
  Trial trial;
};

// The recording fitted with the law of that label, from where its scan begins.
Fitted fitted(unsigned seed, const Extra& extra, const std::string& label) {
  const NominalModel nominal = nominal_model();
  const NamedRecording seen = recorded(seed, extra);
  Fitted f;
  f.runs = {observe(seen.recording, seen.name)};
  f.all = all_candidates(nominal, f.runs);
  const auto at = std::ranges::find(f.all.list, label, &Candidate::name);
  if (at == f.all.list.end()) throw std::runtime_error("no candidate " + label);
  const Trial parent = nominal_trial(fit_nominal(nominal, f.runs), f.all);
  const std::vector<Start> starts = starts_of(*at, parent, f.runs, f.runs, {}, {});
  f.trial =
      f.all.extend(parent, static_cast<size_t>(at - f.all.list.begin()), starts.front(), f.runs);
  return f;
}

// A diagnosis of a trial, as far as improved.toml needs it.
Diagnosis reported(const Fitted& f) {
  Diagnosis d;
  d.verdict = Verdict::unexplained;
  d.empirical = empirical_torques(f.trial, f.all, f.runs);
  d.priors_refined = refined_priors(f.trial);
  const PlatformState& start = f.trial.fit.best.runs.front().initial;
  const Quat& q = start.lab_from_body;
  Replay replay;
  replay.duration_s = f.runs.front().duration_s();
  replay.output_rate_Hz = static_cast<double>(f.runs.front().blocks() - 1) / replay.duration_s;
  replay.initial_attitude = {q.w(), q.x(), q.y(), q.z()};
  replay.initial_rate_rad_s = start.rate_body_rad_s;
  replay.initial_time_s = start.time_s;
  d.replay = replay;
  return d;
}

// improved.toml, propagated, follows the fitted model.
void expect_same_flight(const Fitted& f, const Diagnosis& d) {
  const std::string text = improved_experiment(TomlDocument(nominal_text, "nominal.toml"), d, ".");
  PropagationRun run = read_propagation(Settings(parse_toml(text, "improved.toml")));
  run.options.tolerance = 1e-10;
  const std::vector<PlatformState> propagated = propagate(run).states;
  const Dynamics dynamics(f.trial.fit.best.model_of(0, f.runs.front()));
  const std::vector<PlatformState> wanted =
      propagate(dynamics, f.trial.fit.best.runs.front().initial, f.runs.front().time_s,
                {.tolerance = 1e-10})
          .states;
  ASSERT_EQ(propagated.size(), wanted.size());
  for (size_t i = 0; i < propagated.size(); ++i) {
    EXPECT_NEAR(propagated[i].time_s, wanted[i].time_s, 1e-9);
    EXPECT_LT(propagated[i].lab_from_body.angularDistance(wanted[i].lab_from_body), 1e-6) << i;
  }
}

TEST(EmpiricalLaw, CoggingFliesAgainAndHasAFormula) {
  const Fitted f = fitted(
      1,
      [](const State& s) {
        const Vec3 nose = s.lab_from_body * Vec3::UnitX();
        const Vec3 up = s.lab_from_body.conjugate() * Vec3::UnitZ();
        return Vec3(1e-5 * std::cos(3.0 * std::atan2(nose.y(), nose.x()) - 1.0) * up);
      },
      "unknown in yaw: 3 periods a turn");
  const Diagnosis d = reported(f);
  expect_same_flight(f, d);
  EXPECT_THAT(d.empirical.at(0).formula, HasSubstr("cos(3 ψ − (5"));  // 57 degrees
  EXPECT_THAT(d.empirical[0].looks_like, HasSubstr("three pads"));
}

// A torque decays with 25 s. The fit finds the time constant on a grid that does not contain it.
TEST(EmpiricalLaw, FadingFliesAgainWithItsTimeConstant) {
  const Vec3 torque_N_m(4e-5, -3e-5, 5e-5);
  const Fitted f = fitted(
      2, [&](const State& s) { return Vec3(std::exp(-s.time_s / 25.0) * torque_N_m); },
      "unknown in time: fading");
  const Diagnosis d = reported(f);
  expect_same_flight(f, d);
  const FittedParameter& tau = d.empirical.at(0).parameters.at(0);
  ASSERT_EQ(tau.key, "time_constant_s");
  EXPECT_NEAR(tau.value[0], 25.0, 4.0 * tau.sigma[0]);
  EXPECT_LT(tau.sigma[0], 1.0);
  EXPECT_THAT(d.empirical[0].formula, HasSubstr("exp(−t/(25"));
}

// The law with a fitted exponent.
TEST(EmpiricalLaw, PowerOfTheTiltFliesAgainWithItsExponent) {
  const Fitted f = fitted(
      3,
      [](const State& s) {
        const Vec3 up = s.lab_from_body.conjugate() * Vec3::UnitZ();
        const Vec3 lean = Vec3::UnitZ().cross(up);  // as long as the sine of the tilt
        const double tilt = std::atan2(lean.norm(), up.z());
        return Vec3(2e-4 * std::pow(tilt / 0.1, 2.6) * lean.normalized());
      },
      "unknown in tilt: a power");
  const Diagnosis d = reported(f);
  expect_same_flight(f, d);
  const FittedParameter& exponent = d.empirical.at(0).parameters.at(0);
  ASSERT_EQ(exponent.key, "tilt_exponent");
  EXPECT_NEAR(exponent.value[0], 2.6, 4.0 * exponent.sigma[0]);
  EXPECT_LT(exponent.sigma[0], 0.2);
}

// Where no friction acts it is fitted negative in half of the recordings; an experiment cannot
// state that.
TEST(FoundEffects, LieWithinTheirBounds) {
  int beyond = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Fitted f = fitted(
        seed, [](const State&) { return Vec3(Vec3::Zero()); }, "dry_friction");
    const std::vector<Disturbance>& all = f.trial.fit.best.model.disturbances;
    const double torque_N_m = all[f.trial.disturbances.front()].parameters.front().value;
    inference::Decision decision;
    decision.probability = {1.0};
    const std::vector<FoundEffect> found = found_effects(decision, {f.trial}, f.all);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found.front().parameters.front().value.front(), std::max(0.0, torque_N_m));
    beyond += torque_N_m < 0.0 ? 1 : 0;
  }
  EXPECT_GT(beyond, 0);
}

}  // namespace
}  // namespace photorque
