#include "tools/proof/score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace photorque {
namespace {

class ProofScore : public testing::Test {
 protected:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "proof_score";

  CaseScore scored(const std::string& truth, const std::string& diagnosis) {
    std::filesystem::create_directories(folder_ / "truth");
    std::filesystem::create_directories(folder_ / "diagnosis");
    std::ofstream(folder_ / "truth" / "truth.json") << truth;
    std::ofstream(folder_ / "diagnosis" / "diagnosis.json") << diagnosis;
    return score_case(folder_ / "truth", folder_ / "diagnosis", {});
  }

  void TearDown() override { std::filesystem::remove_all(folder_); }
};

std::string a_tone(const std::string& torque, double phase) {
  return R"({"kind": "periodic_torque", "torque_N_m": )" + torque +
         R"(, "frequency_Hz": 1.0, "phase": )" + std::to_string(phase) + "}";
}

std::string truth_of_tone(const std::string& torque, double phase) {
  return R"({"verdict": "missing_physics", "accept": [["periodic_torque"]], "effects": [)" +
         a_tone(torque, phase) + "]}";
}

std::string found_tone(const std::string& torque, double phase) {
  return R"({"verdict": "missing_physics", "confidence": 0.9, "effects": [{"kind":
      "periodic_torque", "probability": 0.9, "parameters": {
      "torque_N_m": {"value": )" +
         torque + R"(, "sigma": [1e-6, 1e-6, 1e-6]},
      "frequency_Hz": {"value": 1.001, "sigma": 0.001},
      "phase": {"value": )" +
         std::to_string(phase) + R"(, "sigma": 0.1}}}]})";
}

// A sin(2π f t + φ) = −A sin(2π f t + φ + π), and φ means the same after a whole turn.
TEST_F(ProofScore, AmplitudeTurnedRoundHalfAPeriodLaterIsTheSameTone) {
  const std::string truth = truth_of_tone("[1e-5, -2e-5, 0]", 0.5);
  const double half = std::numbers::pi;
  for (const std::string& found :
       {found_tone("[1.2e-5, -2e-5, 0]", 0.6), found_tone("[-1.2e-5, 2e-5, 0]", 0.6 + half),
        found_tone("[-1.2e-5, 2e-5, 0]", 0.6 - 3.0 * half)}) {
    const CaseScore score = scored(truth, found);
    EXPECT_TRUE(score.right);
    ASSERT_EQ(score.pulls.size(), 5u);
    double squares = 0.0;
    for (const double pull : score.pulls) squares += pull * pull;
    // Two sigma in one component of the amplitude, one in the frequency, one in the phase.
    EXPECT_NEAR(squares, 4.0 + 1.0 + 1.0, 1e-4);
  }
}

TEST_F(ProofScore, APhaseThatIsWrongShowsAsSuch) {
  const CaseScore score =
      scored(truth_of_tone("[1e-5, -2e-5, 0]", 0.5), found_tone("[1e-5, -2e-5, 0]", 1.5));
  double largest = 0.0;
  for (const double pull : score.pulls) largest = std::max(largest, std::abs(pull));
  EXPECT_NEAR(largest, 10.0, 1e-4);
}

TEST_F(ProofScore, AWrongNameIsCountedAsSuch) {
  const std::string truth =
      R"({"verdict": "missing_physics", "accept": [["tether"]], "effects": [{"kind": "tether"}]})";
  const CaseScore score = scored(truth, found_tone("[1e-5, 0, 0]", 0.0));
  EXPECT_FALSE(score.right);
  EXPECT_TRUE(score.wrong_name);
  EXPECT_TRUE(score.verdict_right);
}

TEST_F(ProofScore, ANamedEffectWhereNothingIsMissingIsAFalseAlarm) {
  const std::string truth = R"({"verdict": "consistent", "accept": [[]], "effects": []})";
  EXPECT_TRUE(scored(truth, found_tone("[1e-5, 0, 0]", 0.0)).false_alarm);
  const CaseScore quiet =
      scored(truth, R"({"verdict": "consistent", "confidence": 0.9, "effects": []})");
  EXPECT_TRUE(quiet.right);
  EXPECT_FALSE(quiet.false_alarm);
}

// The closed form of Wilson's paper with z = 1.959964, evaluated by hand for 8 of 10.
TEST(Fraction, HasWilsonsInterval) {
  const Fraction fraction{8, 10};
  EXPECT_NEAR(fraction.low(), 0.4901625, 1e-4);
  EXPECT_NEAR(fraction.high(), 0.9433178, 1e-4);
}

}  // namespace
}  // namespace photorque
