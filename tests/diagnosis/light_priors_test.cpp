// Priors of an experiment on light and power. The recordings are made by validation/light, which
// shares nothing with the program.
#include "diagnosis/light/nominal_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "core/errors.h"
#include "core/files.h"
#include "diagnosis/light/diagnose.h"
#include "tests/outside.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// Scans under lamps that shine by a factor more than is stated.
class LightPriors : public testing::Test {
 protected:
  static constexpr double brighter = 0.97, stated_W = 6.29;

  // Replaces all matches of the expression.
  void rewrite(const char* expression, const std::string& format) {
    const std::string before = text_;
    text_ = std::regex_replace(text_, std::regex(expression), format);
    ASSERT_NE(text_, before);
  }
  // Every power known to within 5 %.
  void doubt_powers() {
    rewrite("power_W = ([0-9.]+)",
            "power_W = { value = $1, sigma = " + std::to_string(0.05 * stated_W) + " }");
  }
  Experiment read(const std::string& assignment) const {
    std::vector<std::string> overrides;
    if (!assignment.empty()) overrides.push_back(assignment);
    return resolve_experiment(read_experiment_text(folder_ / "experiment.toml", text_, overrides));
  }
  NominalLight nominal(const LightLab& lab) const {
    return nominal_light(lab, uncertain_keys(folder_ / "experiment.toml", text_, {}),
                         [this](const std::string& more) { return read(more); });
  }
  LightRecording recording(const char* name) const {
    return read_light_recording(folder_ / name, {Quat::Identity(), 298.15});
  }
  Diagnosis diagnosed() const {
    const Experiment experiment = read("");
    const LightLab lab(experiment);
    return diagnose_light(lab, nominal(lab), {recording("scan1.csv.gz")},
                          {recording("scan2.csv.gz")});
  }

  fs::path folder_ = outside::reference_data("light/brighter");
  std::string text_ = read_file(folder_ / "experiment.toml");
};

// Light is proportional to power: an error of 5 % in all powers moves every reading by 5 % of
// itself.
TEST_F(LightPriors, LightMovesAsThePowerDoes) {
  doubt_powers();
  const Experiment experiment = read("");
  const LightLab lab(experiment);
  const NominalLight known = nominal(lab);
  ASSERT_FALSE(known.uncertain.empty());
  const LightRun run(lab, recording("scan1.csv.gz"));
  const Eigen::VectorXd moved = slopes_by_priors(run, known.uncertain).rowwise().sum();
  const std::vector<double> light = run.signals(known.state, run.fields(known.state, nullptr));
  ASSERT_EQ(static_cast<size_t>(moved.size()), light.size());
  for (size_t i = 0; i < light.size(); ++i) {
    const double expected = 0.05 * light[i] / run.row_noise(i);
    EXPECT_NEAR(moved[static_cast<Eigen::Index>(i)], expected, 1e-5 * (1.0 + expected));
  }
}

TEST_F(LightPriors, PowerWithinItsErrorIsNoEffect) {
  const Diagnosis certain = diagnosed();
  ASSERT_EQ(certain.verdict, Verdict::missing_physics);
  ASSERT_EQ(certain.effects.size(), 1u);
  EXPECT_TRUE(certain.priors_refined.empty());
  doubt_powers();
  const Diagnosis uncertain = diagnosed();
  EXPECT_EQ(uncertain.verdict, Verdict::consistent);
  ASSERT_EQ(uncertain.priors_refined.size(), 1u);
  const FittedParameter& power = uncertain.priors_refined[0];
  EXPECT_EQ(power.key, "source[0].power_W");
  EXPECT_NEAR(power.value.at(0), brighter * stated_W, 4.0 * power.sigma.at(0));
  EXPECT_LT(power.sigma.at(0), 0.01 * stated_W);
  EXPECT_GT(power.sigma.at(0), 0.0);
}

// A quantum efficiency of 1 is at the end of its range; a number of cells is known or is not.
TEST_F(LightPriors, NumbersAtTheEndOfTheirRange) {
  rewrite("efficiency = [^\n]+", "efficiency = { value = [1, 1], sigma = [0, 0.02] }");
  {
    const Experiment experiment = read("");
    const LightLab lab(experiment);
    const NominalLight known = nominal(lab);
    ASSERT_EQ(known.uncertain.size(), 1u);
    EXPECT_EQ(known.uncertain[0].component, 1u);
    EXPECT_EQ(known.uncertain[0].value, (std::vector<double>{1.0, 1.0}));
    EXPECT_EQ(known.uncertain[0].low.errors, -LightPrior::part);
    EXPECT_EQ(known.uncertain[0].high.errors, 0.0);
  }
  rewrite("bypass_every = ([0-9]+)", "bypass_every = { value = $1, sigma = 1 }");
  const Experiment experiment = read("");
  const LightLab lab(experiment);
  // In the words of the file: half a diode more is nothing that anybody wrote.
  const std::string refusal = refusal_of([&] { nominal(lab); });
  EXPECT_THAT(refusal, testing::HasSubstr("array.bypass_every: found "));
  EXPECT_THAT(refusal, testing::HasSubstr("with a sigma of 1"));
}

}  // namespace
}  // namespace photorque
