// Curves with an effect that the experiment lacks, made by `validation/light`, whose place or size
// the first recording alone does not determine: the names and places must be right.
#include <gtest/gtest.h>

#include "diagnosis/light/diagnose.h"
#include "diagnosis/light/model/run.h"
#include "diagnosis/light/nominal_light.h"
#include "scenes/experiment/experiment.h"
#include "tests/diagnosis/named.h"
#include "tests/outside.h"

namespace photorque {
namespace {

Diagnosis answer_to(const std::string& name) {
  const std::filesystem::path folder = outside::reference_data("light/" + name);
  const Experiment experiment =
      resolve_experiment(read_experiment_file(folder / "experiment.toml"));
  const LightLab lab(experiment);
  const auto curves = [&](const char* file) -> std::vector<LightRecording> {
    return {read_light_recording(folder / file, {Quat::Identity(), 298.15})};
  };
  const NominalLight stated =
      nominal_light(lab, {}, [&](const std::string&) { return experiment; });
  return diagnose_light(lab, stated, curves("iv1.csv.gz"), curves("iv2.csv.gz"));
}

using Kinds = std::vector<std::string>;

// Two minima of the fitted curves are as deep; the held-out curves separate them.
TEST(LightCase, ABiasOfTheAttitudeIsFoundInTheRightMinimum) {
  const Diagnosis d = answer_to("tilted");
  ASSERT_EQ(kinds_of(d), Kinds{"attitude_bias"}) << d.sentence;
  const FittedParameter& bias = parameter(d, "attitude_bias", "bias_deg");
  EXPECT_NEAR(bias.value[0], 0.9510, 5.0 * bias.sigma[0]);
  EXPECT_NEAR(bias.value[1], 2.8453, 5.0 * bias.sigma[1]);
}

// In the fitted curves most cells explain as much as the right one.
TEST(LightCase, TheCellThatOnlyTheHeldOutCurvesShow) {
  const Diagnosis d = answer_to("one_cell");
  ASSERT_EQ(kinds_of(d), Kinds{"cell_degraded"}) << d.sentence;
  EXPECT_EQ(parameter(d, "cell_degraded", "index").value, std::vector<double>{9.0});
  const FittedParameter& factor = parameter(d, "cell_degraded", "factor");
  EXPECT_NEAR(factor.value[0], 0.6222, 5.0 * factor.sigma[0]);
}

// To first order an LED that points elsewhere explains more than the cell, which shows little until
// it limits its string.
TEST(LightCase, TheCellBesideABadContact) {
  const Diagnosis d = answer_to("cell_and_contact");
  ASSERT_EQ(kinds_of(d), (Kinds{"series_resistance", "cell_degraded"})) << d.sentence;
  EXPECT_EQ(parameter(d, "cell_degraded", "index").value, std::vector<double>{4.0});
}

}  // namespace
}  // namespace photorque
