// diagnosis.json as outside programs read it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "diagnosis/json.h"
#include "tests/diagnosis/sample_diagnosis.h"

namespace photorque {
namespace {

using Json = nlohmann::json;

Json json_of(const Diagnosis& d) {
  Provenance provenance = build_provenance();
  provenance.seed = 7;
  provenance.inputs = {{"run1.csv", "9f3c"}};
  return Json::parse(diagnosis_json(d, provenance));
}

TEST(DiagnosisJson, HoldsEveryKeyOfTheSchema) {
  const Json json = json_of(sample_diagnosis());
  EXPECT_EQ(json["schema"], "photorque.diagnosis/1");
  EXPECT_EQ(json["verdict"], "missing_physics");
  EXPECT_EQ(json["confidence"], 0.97);
  EXPECT_EQ(json["where"]["channels"][0]["name"], "attitude_z_arcsec");
  EXPECT_EQ(json["where"]["channels"][0]["chi2_per_sample"], 8.5);
  EXPECT_EQ(json["where"]["intervals_s"], Json::parse("[[120.0, 400.0]]"));
  EXPECT_EQ(json["where"]["band_Hz"], Json::parse("[0.0, 0.1]"));
  EXPECT_EQ(json["where"]["depends_on"][0]["variable"], "heading");
  EXPECT_EQ(json["where"]["depends_on"][0]["quantity"], "yaw_deg");
  EXPECT_EQ(json["where"]["depends_on"][0]["strength"], 0.8);
  EXPECT_EQ(json["effects"][0]["kind"], "magnetic_dipole");
  EXPECT_EQ(json["effects"][0]["probability"], 0.983);
  EXPECT_EQ(json["effects"][0]["indistinguishable_from"], Json::parse(R"(["room_draft"])"));
  EXPECT_EQ(json["fit"]["chi2_per_sample_before"], 3.68);
  EXPECT_EQ(json["fit"]["chi2_per_sample_after"], 0.984);
  EXPECT_EQ(json["holdout"]["rms_before"]["attitude_z_arcsec"], 95.0);
  EXPECT_EQ(json["holdout"]["rms_after"]["attitude_z_arcsec"], 12.3);
  EXPECT_EQ(json["holdout"]["chi2_per_sample_after"], 1.02);
  EXPECT_EQ(json["alternatives"][0]["log_evidence_relative"], 900.0);
  EXPECT_EQ(json["alternatives"][0]["holdout_chi2_per_sample"], 1.02);
  EXPECT_EQ(json["data"]["rows"], 7000);
  EXPECT_EQ(json["data"]["used"], 6957);
  EXPECT_EQ(json["data"]["rejected"]["gap"], 12);
}

TEST(DiagnosisJson, OmitsAStrengthThatIsNotKnown) {
  Diagnosis d = sample_diagnosis();
  d.where.depends_on = {{"tilt", 0.0}};
  const Json depends = json_of(d)["where"]["depends_on"];
  EXPECT_EQ(depends[0]["variable"], "tilt");
  EXPECT_FALSE(depends[0].contains("strength"));
}

TEST(DiagnosisJson, OneNumberIsANumberAndMoreAreAnArray) {
  const Json effects = json_of(sample_diagnosis())["effects"];
  EXPECT_EQ(effects[0]["parameters"]["dipole_A_m2"]["value"],
            Json::parse("[0.0126, 0.0288, -0.0193]"));
  EXPECT_EQ(effects[1]["parameters"]["latency_s"]["value"], 0.08);
  EXPECT_EQ(effects[1]["parameters"]["latency_s"]["sigma"], 0.0003);
}

TEST(DiagnosisJson, CarriesItsProvenance) {
  const Json provenance = json_of(sample_diagnosis())["provenance"];
  EXPECT_EQ(provenance["version"], build_provenance().version);
  EXPECT_EQ(provenance["git_hash"], build_provenance().git_hash);
  EXPECT_EQ(provenance["seed"], 7);
  EXPECT_EQ(provenance["inputs"]["run1.csv"], "9f3c");
}

// JSON has no infinity: such a number must not make the file unreadable.
TEST(DiagnosisJson, StaysReadableWithoutFiniteNumbersOrFindings) {
  Diagnosis d;
  d.chi2_per_sample_before = std::numeric_limits<double>::infinity();
  d.confidence = std::numeric_limits<double>::quiet_NaN();
  d.sentence = "bad byte \xff";
  const Json json = json_of(d);
  EXPECT_TRUE(json["fit"]["chi2_per_sample_before"].is_null());
  EXPECT_TRUE(json["confidence"].is_null());
  EXPECT_EQ(json["effects"], Json::array());
  EXPECT_TRUE(json["holdout"].is_null());
  EXPECT_EQ(json["verdict"], "consistent");
}

}  // namespace
}  // namespace photorque
