// A proposed manoeuvre, carried out: it separates the effects by the predicted amount.
#include <gmock/gmock.h>

#include "tests/diagnosis/rigid_body_recording.h"

namespace photorque {
namespace {

using namespace rigid_body;

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

}  // namespace
}  // namespace photorque
