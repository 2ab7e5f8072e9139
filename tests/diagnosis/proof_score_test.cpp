#include "tools/scoring/score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/scoring/replay.h"

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

// Friction that drives is beyond physics, however well it fits.
TEST_F(ProofScore, ANumberBeyondPhysicsIsCounted) {
  const std::string truth =
      R"({"verdict": "missing_physics", "accept": [["dry_friction"]], "effects":
          [{"kind": "dry_friction", "torque_N_m": 1e-6}]})";
  const auto found = [](const std::string& value) {
    return R"({"verdict": "missing_physics", "confidence": 0.9, "effects": [{"kind": "dry_friction",
        "probability": 0.9, "parameters": {"torque_N_m": {"value": )" +
           value + R"(, "sigma": 1e-7}}}]})";
  };
  EXPECT_TRUE(scored(truth, found("1.1e-6")).impossible.empty());
  EXPECT_EQ(scored(truth, found("-1.1e-6")).impossible,
            std::vector<std::string>{"dry_friction.torque_N_m"});
}

TEST_F(ProofScore, AKnownEffectBesideAnUnknownLawMayBeNamedOrNot) {
  const std::string truth =
      R"({"verdict": "unexplained", "accept": [["tether"], []], "depends_on": ["heading"],
          "effects": [{"kind": "tether"}, {"kind": "heading_cogging"}]})";
  const auto said = [](const std::string& verdict, const std::string& kinds) {
    return R"({"verdict": ")" + verdict + R"(", "confidence": null, "effects": [)" + kinds + "]}";
  };
  const std::string tether = R"({"kind": "tether", "probability": 0.9})";
  const CaseScore named = scored(truth, said("unexplained", tether));
  EXPECT_TRUE(named.right);
  EXPECT_TRUE(named.known_named);
  EXPECT_TRUE(std::isnan(named.confidence));
  const CaseScore quiet = scored(truth, said("unexplained", ""));
  EXPECT_TRUE(quiet.right);
  EXPECT_FALSE(quiet.known_named);
  EXPECT_FALSE(scored(truth, said("missing_physics", tether)).right);
  const CaseScore wrong =
      scored(truth, said("unexplained", R"({"kind": "dry_friction", "probability": 0.9})"));
  EXPECT_FALSE(wrong.right);
  EXPECT_TRUE(wrong.wrong_name);
}

// The row of that question; an empty one where it was not asked.
ProofRow row_of(const std::vector<CaseScore>& scores, const std::string& part) {
  for (const ProofRow& row : proof_rows(scores)) {
    if (row.question.find(part) != std::string::npos) return row;
  }
  return {};
}

TEST_F(ProofScore, ANameThatContradictsItsOwnPredictionIsCounted) {
  const std::string truth =
      R"({"verdict": "missing_physics", "accept": [["tether"]], "effects": [{"kind": "tether"}]})";
  const auto with = [](const std::string& held_out) {
    return R"({"verdict": "missing_physics", "confidence": 0.9, "effects": [{"kind": "tether",
        "probability": 0.9}], "holdout": {"chi2_per_sample_after": 1.5)" +
           held_out + "}}";
  };
  const std::vector<CaseScore> scores = {scored(truth, with(R"(, "predictive_sigma": 1.2)")),
                                         scored(truth, with(R"(, "predictive_sigma": 7.0)")),
                                         scored(truth, with(""))};
  EXPECT_EQ(row_of(scores, "contradicts its own prediction").fraction.hits, 1);
  EXPECT_EQ(row_of(scores, "contradicts its own prediction").fraction.of, 2);
  EXPECT_EQ(row_of(scores, "without a stated prediction").fraction.hits, 1);
}

// Of three answers that leave 1.0, 1.2 and 3.0 times what the oracle does, the last expected it.
TEST_F(ProofScore, AnswersThatExpectMuchAreToldApart) {
  std::vector<CaseScore> scores(3);
  const double held[] = {1.0, 1.2, 3.0}, expected[] = {1.01, 1.02, 2.5};
  for (size_t i = 0; i < 3; ++i) {
    scores[i].answered = true;
    scores[i].verdict = "missing_physics";
    scores[i].oracle_chi2 = 1.0;
    scores[i].holdout_chi2 = held[i];
    scores[i].expected_chi2 = expected[i];
  }
  EXPECT_EQ(row_of(scores, "within 10 %").fraction.hits, 1);
  EXPECT_EQ(row_of(scores, "within 10 %").fraction.of, 3);
  EXPECT_EQ(row_of(scores, "the same, of those").fraction.hits, 1);
  EXPECT_EQ(row_of(scores, "the same, of those").fraction.of, 2);
}

TEST_F(ProofScore, TheNoiseOfAReplayIsTheOneThatWasFound) {
  const auto diagnosis = nlohmann::json::parse(R"({"instruments": [
      {"channel": "attitude_y_arcsec", "what": "noise_level", "value": 67.0},
      {"channel": "attitude_z_arcsec", "what": "correlation_time", "value": 3.0},
      {"channel": "gyro_x_rad_s", "what": "noise_level", "value": 2e-4}]})");
  const std::array<double, 3> used = found_noise_arcsec(diagnosis, {37.0, 37.0, 12.0});
  EXPECT_EQ(used, (std::array<double, 3>{37.0, 67.0, 12.0}));
}

TEST_F(ProofScore, AnImprovedExperimentHasToFlyAsStated) {
  const std::string truth = R"({"verdict": "consistent", "accept": [[]], "effects": []})";
  const auto flight = [&](const std::string& runs) {
    std::filesystem::create_directories(folder_ / "diagnosis");
    std::ofstream(folder_ / "diagnosis" / "runs.json") << runs;
    return scored(truth, R"({"verdict": "consistent", "confidence": 0.9, "effects": [],
                             "fit": {"chi2_per_sample_after": 1.1}})");
  };
  EXPECT_TRUE(replays_as_stated(
      flight(R"({"processor_s": 3.0, "exit_status": 0, "replay_status": 0, "replay_chi2": 1.2})")));
  EXPECT_FALSE(replays_as_stated(
      flight(R"({"processor_s": 3.0, "exit_status": 0, "replay_status": 0, "replay_chi2": 4.0})")));
  // Where the attitudes' own misfit is stated, that is what they have to repeat.
  const std::string misfits = R"("channels": [{"name": "gyro_x_rad_s", "chi2_of_median": 9.0},
      {"name": "attitude_x_arcsec", "chi2_of_median": 2.0},
      {"name": "attitude_y_arcsec", "chi2_of_median": 4.0}])";
  const auto replayed = [&](double chi2) {
    std::ofstream(folder_ / "diagnosis" / "runs.json")
        << R"({"exit_status": 0, "replay_status": 0, "replay_chi2": )" << chi2 << "}";
    return replays_as_stated(scored(truth, R"({"verdict": "consistent", "confidence": 0.9,
        "effects": [], "fit": {"chi2_per_sample_after": 1.1, )" +
                                               misfits + "}}"));
  };
  EXPECT_TRUE(replayed(4.1));  // 0.2 + 1.33 · 3 = 4.19
  EXPECT_FALSE(replayed(4.3));
  const CaseScore failed = flight(R"({"processor_s": 61.0, "exit_status": 3, "replay_status": 2})");
  EXPECT_FALSE(replays_as_stated(failed));
  EXPECT_EQ(row_of({failed}, "exits other than 0").fraction.hits, 1);
}

// Ten answers at 0.9 of which six are right, ten at 0.45 of which five are: (|9 − 6| + |4.5 −
// 5|)/20.
TEST_F(ProofScore, CalibrationErrorIsTheMeanDistanceByBins) {
  std::vector<CaseScore> scores(20);
  for (size_t i = 0; i < scores.size(); ++i) {
    scores[i].answered = true;
    scores[i].confidence = i < 10 ? 0.9 : 0.45;
    scores[i].right = i < 6 || i >= 15;
  }
  double error = -1.0;
  for (const Quantity& q : proof_quantities(scores)) {
    if (q.name == "confidence_calibration_error") error = q.estimate.value;
  }
  EXPECT_NEAR(error, 0.175, 1e-12);
}

// What another program states may be more than 1 by rounding.
TEST_F(ProofScore, EveryAnswerIsInTheTableOfCalibration) {
  std::vector<CaseScore> scores(12);
  for (size_t i = 0; i < scores.size(); ++i) {
    scores[i].answered = true;
    scores[i].confidence = i == 0 ? 1.0 + 4e-16 : static_cast<double>(i) / 11.0;
  }
  double answers = 0.0;
  const Table table = proof_calibration(scores);
  for (const double n : table.column("answers").values) answers += n;
  EXPECT_EQ(answers, 12.0);
}

// The closed form of Wilson's paper with z = 1.959964, evaluated by hand for 8 of 10.
TEST(Fraction, HasWilsonsInterval) {
  const Fraction fraction{8, 10};
  EXPECT_NEAR(fraction.low(), 0.4901625, 1e-4);
  EXPECT_NEAR(fraction.high(), 0.9433178, 1e-4);
}

}  // namespace
}  // namespace photorque
