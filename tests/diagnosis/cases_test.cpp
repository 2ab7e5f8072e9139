// Recordings with an injected effect, made by an independent simulator (tests/data/cases): the
// verdict and the names must be right.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/files.h"
#include "diagnosis/attitude/diagnose.h"
#include "scenes/experiment/toml_reader.h"
#include "tests/outside.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

const fs::path cases = outside::reference_data("cases");

Diagnosis diagnose_case(const fs::path& folder) {
  const Settings settings(
      std::make_shared<const SettingsNode>(read_toml(folder / "experiment.toml")));
  const auto recording = [&](const char* name) {
    return std::vector<NamedRecording>{{name, read_recording(folder / name)}};
  };
  return diagnose(read_attitude_model(settings), recording("run1.csv.gz"),
                  recording("run2.csv.gz"));
}

class InjectedCase : public testing::TestWithParam<const char*> {};

TEST_P(InjectedCase, IsNamedRightly) {
  const fs::path folder = cases / GetParam();
  const nlohmann::json truth = nlohmann::json::parse(read_file(folder / "truth.json"));
  const Diagnosis found = diagnose_case(folder);
  EXPECT_EQ(name_of(found.verdict), truth["verdict"]) << found.sentence;
  std::set<std::string> names;
  for (const FoundEffect& effect : found.effects) names.insert(effect.kind);
  bool accepted = false;
  for (const auto& set : truth["accept"]) {
    accepted = accepted || set.get<std::set<std::string>>() == names;
  }
  EXPECT_TRUE(accepted) << found.sentence;
  for (const std::string variable : truth["depends_on"]) {
    ASSERT_FALSE(found.where.depends_on.empty());
    EXPECT_EQ(found.where.depends_on.front().variable, variable);
  }
}

INSTANTIATE_TEST_SUITE_P(OfAnotherProgram, InjectedCase,
                         testing::Values("01", "02", "03", "04", "05", "06", "07", "08", "09", "10",
                                         "11", "12"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace photorque
