// Recordings with an injected effect, made by simulators that share no code with the program: the
// verdict and the names must be right.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/files.h"
#include "diagnosis/attitude/diagnose.h"
#include "scenes/experiment/toml.h"
#include "tests/outside.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

Diagnosis diagnose_case(const fs::path& folder) {
  const Settings settings(parse_toml(read_file(folder / "experiment.toml"), "experiment.toml"));
  const auto recording = [&](const char* name) {
    return std::vector<NamedRecording>{{name, read_recording(folder / name)}};
  };
  return diagnose(read_attitude_model(settings), recording("run1.csv.gz"),
                  recording("run2.csv.gz"));
}

// Diagnoses the case in `folder` and compares with its truth.json.
void expect_named_rightly(const fs::path& folder) {
  const nlohmann::json truth = nlohmann::json::parse(read_file(folder / "truth.json"));
  const Diagnosis found = diagnose_case(folder);
  EXPECT_EQ(name_of(found.verdict), truth["verdict"].get<std::string>()) << found.sentence;
  std::set<std::string> names;
  for (const FoundEffect& effect : found.effects) names.insert(effect.kind);
  bool accepted = false;
  for (const auto& set : truth["accept"]) {
    accepted = accepted || set.get<std::set<std::string>>() == names;
  }
  EXPECT_TRUE(accepted) << found.sentence;
  for (const std::string variable : truth["depends_on"]) {
    ASSERT_FALSE(found.where.depends_on.empty());
    // The contract's word for the azimuth of body x.
    EXPECT_EQ(found.where.depends_on.front().variable, variable == "heading" ? "yaw" : variable);
  }
}

class CaseOfAnotherProgram : public testing::TestWithParam<const char*> {};

// By a simulator in another language, or by a multibody engine (tests/data/dart_mechanisms.py): a
// part on a hinge that is not round about it, and one that is let go deflected.
TEST_P(CaseOfAnotherProgram, IsNamedRightly) {
  expect_named_rightly(outside::reference_data("cases") / GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, CaseOfAnotherProgram,
                         testing::Values("01", "02", "03", "04", "05", "06", "07", "08", "09", "10",
                                         "11", "12", "appendage", "deflected"),
                         [](const auto& one) { return std::string(one.param); });

// Strong friction, which `propagate` made of the true model: the nominal model lacks it. Platforms
// that the experiment calls free, and that rest on something because it names a bearing's drag.
std::set<std::string> names_found(const std::string& name, const std::vector<std::string>& runs) {
  const fs::path folder = outside::reference_data("faults") / name;
  const Settings settings(parse_toml(read_file(folder / "belief.toml"), "belief.toml"));
  std::vector<std::vector<NamedRecording>> sets(2);
  for (size_t i = 0; i < runs.size(); ++i) {
    sets[i].push_back({runs[i], read_recording(folder / runs[i])});
  }
  const Diagnosis found = diagnose(read_attitude_model(settings), sets[0], sets[1]);
  EXPECT_EQ(found.verdict, Verdict::missing_physics) << found.sentence;
  std::set<std::string> names;
  for (const FoundEffect& effect : found.effects) names.insert(effect.kind);
  return names;
}

using Names = std::set<std::string>;

TEST(StrongFriction, OfATabletop) {
  EXPECT_EQ(names_found("dry_strong", {"run.csv.gz"}), Names({"dry_friction"}));
}

TEST(StrongFriction, OfAPendulum) {
  EXPECT_EQ(names_found("dry_pendulum", {"run.csv.gz"}), Names({"dry_friction"}));
}

// Each alone has the wrong sign beside the nominal drag.
TEST(StrongFriction, BesideADragThatBothStandInFor) {
  EXPECT_EQ(names_found("spin_pair", {"run1.csv.gz", "run2.csv.gz"}),
            Names({"air_pressure_drag", "dry_friction"}));
}

}  // namespace
}  // namespace photorque
