// The engine on recordings of a rigid body: one verdict of each kind, and a recording whose rates
// are in another unit than its header says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "attitude/estimation/fit.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/diagnose.h"
#include "diagnosis/attitude/effects/scan.h"
#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/attitude/findings.h"
#include "tests/diagnosis/rigid_body_recording.h"

namespace photorque {
namespace {

using namespace rigid_body;

Diagnosis diagnosed(const Extra& extra, double gyro_unit = 1.0) {
  DiagnoseOptions options;
  options.limits.search.max_effects = 1;
  return diagnose(nominal_model(), {recorded(1, extra, gyro_unit)}, {recorded(2, extra, gyro_unit)},
                  options);
}

Vec3 nothing(const State&) {
  return Vec3::Zero();
}

TEST(Diagnose, FindsNothingWhereNothingIsMissing) {
  const Diagnosis d = diagnosed(nothing);
  EXPECT_EQ(d.verdict, Verdict::consistent);
  EXPECT_TRUE(d.effects.empty());
  EXPECT_TRUE(d.warnings.empty());
  EXPECT_NEAR(d.chi2_per_sample_after, 1.0, 5.0 * std::sqrt(2.0 / 3600.0));
  EXPECT_EQ(d.samples, 3600);
}

TEST(Diagnose, NamesADipoleAndMeasuresIt) {
  const Vec3 dipole_A_m2(0.02, -0.03, 0.01);
  const Diagnosis d = diagnosed(
      [&](const State& s) { return dipole_A_m2.cross(s.lab_from_body.conjugate() * field_lab_T); });
  ASSERT_EQ(d.verdict, Verdict::missing_physics);
  ASSERT_EQ(d.effects.size(), 1u);
  EXPECT_EQ(d.effects[0].kind, "magnetic_dipole");
  EXPECT_GT(d.effects[0].probability, 0.9);
  const FittedParameter& found = d.effects[0].parameters.at(0);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto i = static_cast<size_t>(k);
    EXPECT_NEAR(found.value[i], dipole_A_m2[k], 4.0 * found.sigma[i]);
    EXPECT_LT(found.sigma[i], 0.005);
  }
  ASSERT_TRUE(d.holdout.has_value());
  EXPECT_LT(d.holdout->chi2_per_sample_after, 1.15);
  EXPECT_GT(d.holdout->chi2_per_sample_before, 1.5);
  // The best explanation predicted the held-out data.
  ASSERT_TRUE(d.alternatives.front().holdout_chi2_per_sample.has_value());
  EXPECT_NEAR(*d.alternatives.front().holdout_chi2_per_sample, 1.0, 0.15);
}

size_t place_of(const std::string& label, const Candidates& all) {
  const auto at = std::ranges::find(all.list, label, &Candidate::name);
  if (at == all.list.end()) throw std::runtime_error("no candidate " + label);
  return static_cast<size_t>(at - all.list.begin());
}

// A dipole and a draught together: what the slopes at the nominal model predict is what the fit
// gains.
TEST(Score, PredictsTheGainOfTwoEffects) {
  const Vec3 dipole_A_m2(0.01, -0.02, 0.01), draught_lab_N_m(4e-7, -3e-7, 0.0);
  const NamedRecording seen = recorded(3, [&](const State& s) {
    const Quat body_from_lab = s.lab_from_body.conjugate();
    return Vec3(dipole_A_m2.cross(body_from_lab * field_lab_T) + body_from_lab * draught_lab_N_m);
  });
  const std::vector<Observation> runs = {observe(seen.recording, seen.name)};
  const Fit nominal = fit_nominal(nominal_model(), runs);
  const Candidates all = all_candidates(nominal_model(), runs);
  const size_t dipole = place_of("magnetic_dipole", all), draught = place_of("room_draft", all);
  const Trial before = nominal_trial(nominal, all);
  const inference::LinearProblem problem = all.linear_problem(
      before, {{dipole, {all[dipole].start}}, {draught, {all[draught].start}}}, runs);
  const std::vector<Score> alone =
      score(nominal, runs, {{{all[dipole].start}}, {{all[draught].start}}});
  std::map<std::vector<size_t>, inference::Subset> predicted;
  for (const inference::Subset& s : inference::best_subsets(problem, 2, {})) {
    predicted[s.groups] = s;
  }
  EXPECT_NEAR(predicted[{0}].gain, alone[0].gain, 1e-6 * alone[0].gain);
  EXPECT_NEAR(predicted[{1}].gain, alone[1].gain, 1e-6 * alone[1].gain);
  EXPECT_NEAR(predicted[{}].gain, 0.0, 1e-9);

  const Trial one = all.extend(nominal_trial(nominal, all), dipole, {all[dipole].start}, runs);
  const Trial both = all.extend(one, draught, {all[draught].start}, runs);
  const double gained = nominal.chi2 - both.fit.chi2;
  EXPECT_NEAR((predicted[{0, 1}].gain), gained, 0.05 * gained);
  EXPECT_GT(gained, nominal.chi2 - one.fit.chi2 + 20.0);
  // Its evidence beside that of the fits.
  EXPECT_NEAR((predicted[{0, 1}].log_evidence - predicted[{0}].log_evidence),
              both.log_evidence - one.log_evidence,
              0.05 * (both.log_evidence - one.log_evidence) + 1.0);

  // About the fit of both, this form predicts the cost of removing one of them.
  const inference::LinearProblem about = all.linear_problem(both, all.terms_of(both), runs);
  for (const inference::Subset& s : inference::best_subsets(about, 2, {})) {
    if (s.groups.size() == 2) {
      EXPECT_NEAR(s.gain, 0.0, 0.1);
    }
    if (s.groups == std::vector<size_t>{0}) {
      const double lost = one.fit.chi2 - both.fit.chi2;
      EXPECT_NEAR(-s.gain, lost, 0.05 * lost);
    }
  }
}

// A camera that sees every second row: what is slow has a mirror image at half the rate of the
// rows, 2.5 Hz, in its readings, which is no line.
TEST(Scan, TakesNoMirrorImageForALine) {
  NamedRecording seen = recorded(5, [](const State&) { return Vec3(3e-6, -2e-6, 2e-5); });
  for (size_t c = 0; c < 4; ++c) {
    std::vector<double>& values = seen.recording.channels[c].values;
    for (size_t row = 1; row < values.size(); row += 2) values[row] = NAN;
  }
  const std::vector<Observation> runs = {observe(seen.recording, seen.name)};
  const Fit fit = fit_nominal(nominal_model(), runs);
  EXPECT_GT(fit.chi2_per_sample(), 1.5);  // there is something slow
  for (const double line_Hz : line_frequencies_Hz(fit, runs, {})) EXPECT_LT(line_Hz, 2.0);
}

// An appendage of a twelfth of the platform's inertia that rings for 20 s: a fit finds it from
// within its resonance alone, and from no axis at all. The platform moves as the law propagates it.
TEST(Scan, StartsAnAppendageWithinItsResonance) {
  constexpr double frequency_Hz = 0.93, damping = 0.009, appendage_kg_m2 = 0.01;
  const Vec3 axis = Vec3(-0.44, -0.86, 0.25).normalized();
  const NamedRecording still = recorded(8, nothing);
  Observation seen = observe(still.recording, still.name);
  const NominalModel nominal = nominal_model();
  AttitudeModel truth = nominal.model;
  const DisturbanceContext context{truth.platform, truth.environment};
  truth.disturbances.push_back(make_disturbance_of("flexible_mode",
                                                   {{"axis", {axis.x(), axis.y(), axis.z()}},
                                                    {"frequency_Hz", {frequency_Hz}},
                                                    {"damping", {damping}},
                                                    {"inertia_kg_m2", {appendage_kg_m2}}},
                                                   context));
  const Dynamics dynamics(truth);
  PlatformState initial = dynamics.initial_state(Vec3(0.03, -0.02, 0.08));
  initial.lab_from_body = Eigen::AngleAxisd(0.12, Vec3::UnitX());
  PredictionOptions options;
  options.keep_residuals = true;
  const Prediction moved = predict(dynamics, initial, seen, {}, options);
  ASSERT_EQ(moved.states.size(), seen.blocks());
  for (size_t i = 0; i < seen.blocks(); ++i) {
    seen.attitude[i] = moved.states[i].lab_from_body;
    seen.gyro_rad_s[i] = moved.states[i].rate_body_rad_s;
  }
  for (int channel = 0; channel < 6; ++channel) seen.noise.set(channel, {1e-7, 0.0, 0.0});
  const std::vector<Observation> runs = {seen};
  const Candidates all = all_candidates(nominal, runs);
  const std::vector<Start> starts =
      starts_of(all[place_of("flexible_mode", all)], nominal_trial(fit_nominal(nominal, runs), all),
                runs, runs, {}, {});
  const auto best = std::ranges::max_element(starts, {}, &Start::gain);
  ASSERT_NE(best, starts.end());
  const Disturbance& d = best->disturbance;
  EXPECT_NEAR(parameter_of(d, "frequency_Hz").value, frequency_Hz, 0.01 * frequency_Hz);
  EXPECT_NEAR(parameter_of(d, "inertia_kg_m2").value, appendage_kg_m2, 0.3 * appendage_kg_m2);
  EXPECT_GT(std::abs(vector_of(d, "axis").normalized().dot(axis)), 0.95);
}

// The torque equation is homogeneous: a third of the inertia explains a torque three times as
// large.
TEST(Trial, AThirdOfTheInertiaIsNoExplanation) {
  const auto thrice = [](const State& s) {
    const Vec3 gravity = s.lab_from_body.conjugate() * Vec3(0, 0, -gravity_m_s2);
    return Vec3(2.0 * mass_kg * offset_m.cross(gravity));
  };
  const NamedRecording seen = recorded(6, thrice);
  const std::vector<Observation> runs = {observe(seen.recording, seen.name)};
  const NominalModel nominal = nominal_model();
  const Candidates all = all_candidates(nominal, runs);
  const size_t error = place_of("inertia_error", all);
  FitSettings settings;
  settings.max_iterations = 60;
  const Trial trial = all.extend(nominal_trial(fit_nominal(nominal, runs), all), error,
                                 {all[error].start}, runs, settings);
  EXPECT_THAT(trial.objection, testing::HasSubstr("inertia would change by"));
}

// A cable that pushes by less than its error is one of no stiffness at all, and what was fitted
// beside it becomes what it is alone; one that pushes beyond doubt is left as it is, for others to
// object to.
TEST(Trial, NumbersBeyondPhysicsAreRefitted) {
  const auto trial_of = [](unsigned seed, double push_N_m_per_rad, bool with_cable) {
    const NamedRecording seen = recorded(seed, [&](const State& s) {
      const Eigen::AngleAxisd turn(s.lab_from_body);
      return Vec3(s.lab_from_body.conjugate() * Vec3(3e-6, -2e-6, 0.0) +
                  push_N_m_per_rad * turn.angle() * turn.axis());
    });
    const std::vector<Observation> runs = {observe(seen.recording, seen.name)};
    const Candidates all = all_candidates(nominal_model(), runs);
    const size_t draught = place_of("room_draft", all), cable = place_of("tether", all);
    Trial trial = all.extend(nominal_trial(fit_nominal(nominal_model(), runs), all), draught,
                             {all[draught].start}, runs);
    if (with_cable) trial = all.extend(trial, cable, {all[cable].start}, runs);
    return std::pair(trial, within_physics(trial, all, runs));
  };
  const auto value = [](const Trial& t, size_t candidate, size_t p) {
    return t.fit.best.model.disturbances.at(t.disturbances.at(candidate)).parameters.at(p).value;
  };
  int beyond = 0;
  for (unsigned seed = 21; seed < 27; ++seed) {
    const auto [fitted, within] = trial_of(seed, 0.0, true);
    if (value(fitted, 1, 0) >= 0.0) {
      EXPECT_EQ(value(within, 1, 0), value(fitted, 1, 0));
      continue;
    }
    ++beyond;
    const Trial alone = trial_of(seed, 0.0, false).first;
    EXPECT_NEAR(value(within, 1, 0), 0.0, 1e-20);  // but for rounding, of 1e-6 N m/rad
    EXPECT_NEAR(within.fit.chi2, alone.fit.chi2, 0.01);
    for (size_t p = 0; p < 2; ++p) {
      EXPECT_NEAR(value(within, 0, p), value(alone, 0, p), 1e-4 * std::abs(value(alone, 0, p)));
    }
  }
  EXPECT_GE(beyond, 1);
  const auto [fitted, within] = trial_of(27, 1e-5, true);
  EXPECT_LT(value(fitted, 1, 0), -0.5e-5);
  EXPECT_EQ(value(within, 1, 0), value(fitted, 1, 0));
}

// Weight that bends the structure alike in all directions shifts its centre of mass, so that only
// differences of the compliances are known, far better than each of them: what is fitted below zero
// goes back to it together, and the motion stays what it was.
TEST(Trial, CompliancesGoBackWithinPhysicsTogether) {
  // The stated centre of mass brings their mean below zero.
  const Vec3 compliance_s2 = Vec3(1e-8, 8e-8, 1.3e-7) - Vec3::Constant(1.6e-7);
  for (unsigned seed = 31; seed < 37; ++seed) {
    const NamedRecording seen = recorded(seed, [&](const State& s) {
      const Vec3 down(0.0, 0.0, -gravity_m_s2);
      const Vec3 gravity = s.lab_from_body.conjugate() * down;
      return Vec3(mass_kg * compliance_s2.cwiseProduct(gravity - down).cross(gravity));
    });
    const std::vector<Observation> runs = {observe(seen.recording, seen.name)};
    const Candidates all = all_candidates(nominal_model(), runs);
    const size_t sag = place_of("elastic_sag", all);
    const Trial fitted = all.extend(nominal_trial(fit_nominal(nominal_model(), runs), all), sag,
                                    {all[sag].start}, runs);
    const auto values = [](const Trial& t) {
      const auto& p = t.fit.best.model.disturbances.at(t.disturbances.at(0)).parameters;
      return Vec3(p[0].value, p[1].value, p[2].value);
    };
    const Trial within = within_physics(fitted, all, runs);
    SCOPED_TRACE(testing::PrintToString(
        std::vector<double>{values(fitted).x(), values(fitted).y(), values(fitted).z()}));
    EXPECT_GE(values(within).minCoeff(), 0.0);
    EXPECT_LT(within.fit.chi2, fitted.fit.chi2 + 1.0);
    ASSERT_LT(values(fitted).minCoeff(), -1e-8);
    const Vec3 change = values(within) - values(fitted);
    EXPECT_LT(change.maxCoeff() - change.minCoeff(), 0.1 * change.maxCoeff());
    // Each brought back alone is another motion.
    Hypothesis clamped = fitted.fit.best;
    for (size_t k = 0; k < 3; ++k) {
      double& value = clamped.model.disturbances[fitted.disturbances[0]].parameters[k].value;
      value = std::max(value, 0.0);
    }
    EXPECT_GT(sums_at(clamped, runs, {}).chi2, fitted.fit.chi2 + 100.0);
  }
}

TEST(Diagnose, CallsCoggingUnexplainedAndMeasuresItsTorque) {
  constexpr double amplitude_N_m = 1e-5;
  const Diagnosis d = diagnosed([&](const State& s) {
    const Vec3 nose = s.lab_from_body * Vec3::UnitX();
    const double heading = std::atan2(nose.y(), nose.x());
    const Vec3 up = s.lab_from_body.conjugate() * Vec3::UnitZ();
    return Vec3(amplitude_N_m * std::sin(3.0 * heading) * up);
  });
  ASSERT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_TRUE(d.effects.empty());
  ASSERT_FALSE(d.where.depends_on.empty());
  EXPECT_EQ(d.where.depends_on.front().variable, "yaw");
  ASSERT_EQ(d.empirical.size(), 1u);
  const EmpiricalTorque& torque = d.empirical.front();
  ASSERT_EQ(torque.standard_error_N_m.size(), torque.at.size());
  for (size_t i = 0; i < torque.at.size(); ++i) {
    const double true_N_m = amplitude_N_m * std::sin(3.0 * torque.at[i] * degree_rad);
    const double error_N_m = torque.standard_error_N_m[i].z();
    EXPECT_LT(error_N_m, 1e-6);
    // A bin is ten degrees wide: its mean is 1 % below the wave's top.
    EXPECT_NEAR(torque.torque_N_m[i].z(), true_N_m, 4.0 * error_N_m + 0.12 * amplitude_N_m);
  }
}

// A strong torque over few readings: the nominal model diverges, and the pieces into which the run
// would be cut have too few attitudes to start from.
TEST(Diagnose, AShortRunThatDivergesIsStillAnswered) {
  const auto pull = [](const State&) { return Vec3(3e-3, 0, 0); };
  NamedRecording brief = recorded(4, pull);
  constexpr size_t rows = 40;
  brief.recording.time_s.resize(rows);
  for (Channel& channel : brief.recording.channels) channel.values.resize(rows);
  brief.recording.report.rows_read = brief.recording.report.rows_kept = rows;
  DiagnoseOptions options;
  options.limits.search.max_effects = 1;
  const Diagnosis d = diagnose(nominal_model(), {brief}, {}, options);
  EXPECT_GT(d.chi2_per_sample_before, 20.0);
  EXPECT_NE(d.verdict, Verdict::consistent);
}

// A header in degrees over numbers in radians arrives here divided by 57, the
// reverse as 57 times too much.
TEST(Diagnose, ReportsRatesInAnotherUnitAsAConventionError) {
  for (const double unit : {degree_rad, 1.0 / degree_rad}) {
    const Diagnosis d = diagnosed(nothing, unit);
    EXPECT_EQ(d.verdict, Verdict::consistent);
    ASSERT_EQ(d.warnings.size(), 2u);
    EXPECT_THAT(d.warnings[0], testing::HasSubstr("convention"));
    EXPECT_THAT(d.warnings[0],
                testing::HasSubstr(unit < 1.0 ? "radians per second" : "degrees per second"));
  }
}

// A proposed manoeuvre, carried out: it separates the effects by the predicted amount.

double log_evidence_of(const Diagnosis& d, const std::string& kind) {
  for (const Alternative& a : d.alternatives) {
    if (a.kinds == std::vector<std::string>{kind}) return a.log_evidence_relative;
  }
  ADD_FAILURE() << kind << " is no alternative";
  return 0.0;
}

// Drag with the square of the rate, over 1 % of run-down: friction with the power 1.5 fits as well.
TEST(Manoeuvre, SeparatesTwoLawsOfDragAsPredicted) {
  const auto drag = [](const State& s) { return Vec3(-1e-4 * s.rate_rad_s.norm() * s.rate_rad_s); };
  NominalModel nominal = nominal_model();
  Parameter& coefficient = nominal.model.disturbances[1].parameters[0];
  coefficient.value = drag_N_m_s;
  coefficient.sigma = 2e-7;
  DiagnoseOptions options;
  options.limits.search.max_effects = 1;
  const NamedRecording usual = recorded(1, drag);
  const Diagnosis before = diagnose(nominal, {usual}, {}, options);
  ASSERT_EQ(before.verdict, Verdict::missing_physics);
  ASSERT_EQ(before.effects.size(), 1u);
  ASSERT_FALSE(before.manoeuvres.empty());
  const auto proposed =
      std::find_if(before.manoeuvres.begin(), before.manoeuvres.end(), [](const Manoeuvre& m) {
        return std::set<std::string>(m.separates.begin(), m.separates.end()) ==
               std::set<std::string>{"air_friction", "air_pressure_drag"};
      });
  ASSERT_NE(proposed, before.manoeuvres.end());
  ASSERT_THAT(proposed->text, testing::HasSubstr("three times its present rate"));
  const double predicted = proposed->log_evidence_expected;

  NamedRecording faster = recorded(1, drag, 1.0, 3.0);
  faster.name = "faster.csv";
  const Diagnosis after = diagnose(nominal, {usual, faster}, {}, options);
  ASSERT_EQ(after.effects.size(), 1u);
  EXPECT_EQ(after.effects[0].kind, "air_pressure_drag");
  EXPECT_TRUE(after.effects[0].indistinguishable_from.empty());
  const double lead =
      log_evidence_of(after, "air_pressure_drag") - log_evidence_of(after, "air_friction");
  // The lead scatters by √(2 · lead) or so, the coefficient that the first run gave by 2 %.
  EXPECT_NEAR(lead, predicted, 5.0 * std::sqrt(2.0 * predicted) + 0.1 * predicted);
  EXPECT_GT(predicted, 100.0);
}

// Three numbers: x − y is known to 2e-11, the third against their mean ten times worse, and the sum
// of all hardly.
Mat3 differences_alone() {
  const Vec3 all = Vec3::Ones() / std::sqrt(3.0), one = Vec3(1, -1, 0) / std::sqrt(2.0),
             other = Vec3(1, 1, -2) / std::sqrt(6.0);
  return 3e-14 * all * all.transpose() + 2e-22 * one * one.transpose() +
         2e-20 * other * other.transpose();
}

TEST(KnownTogether, StatesTheKnownDifferences) {
  // The error of x − y is √(2e-22 · 2) = 2.0e-11.
  EXPECT_EQ(known_together(Vec3(4.4e-10, 0, 2.2e-10), differences_alone()),
            "x − y = (4.40 ± 0.20)×10⁻¹⁰");
  EXPECT_EQ(known_together(Vec3(0, 4.4e-10, 2.2e-10), differences_alone()),
            "−x + y = (4.40 ± 0.20)×10⁻¹⁰");
}

TEST(KnownTogether, IsSilentWhereNothingOrEachIsKnown) {
  EXPECT_EQ(known_together(Vec3(2e-11, 0, 1e-11), differences_alone()), "");
  EXPECT_EQ(known_together(Vec3(1, 2, 3), Mat3::Identity() * 0.01), "");
  EXPECT_EQ(known_together(Vec3(1, -1, 0), Mat3::Identity()), "");
  EXPECT_EQ(known_together(Vec3::Zero(), Mat3::Zero()), "");
}

}  // namespace
}  // namespace photorque
