// Adding a kind is one new file and one word. This program is the library with one word more in
// each registry (tests/CMakeLists.txt) and one file for each (tests/kinds/added).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "attitude/studies/budget.h"
#include "diagnosis/attitude/effects/trial.h"
#include "images/writers/product.h"
#include "receivers/kind.h"
#include "sources/lamps/kind.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

const std::string added = "added_torque";

TEST(AddedDisturbance, IsReadFromAnExperiment) {
  const AttitudeModel model = with(bench_model(), added, "torque_N_m = 2e-4");
  const PlatformState state = state_of(model, Quat::Identity(), Vec3::Zero(), 0.0, 1800.0);
  EXPECT_DOUBLE_EQ(torque_body_N_m(model, state).x(), 1e-4);
}

TEST(AddedDisturbance, IsScreened) {
  const AttitudeModel bench = bench_model();
  const std::vector<Effect> all = catalogue(context_of(bench));
  const auto effect = std::ranges::find(all, added, &Effect::kind);
  ASSERT_NE(effect, all.end());
  EXPECT_EQ(effect->explanation, "something grows with the charge drawn");
  EXPECT_EQ(effect->how.needs, Requirement::charge);
  const AttitudeModel model = bench_model();
  EXPECT_EQ(disturbance_of(*effect, {model.platform, model.environment}).parameters.size(), 1u);
}

TEST(AddedDisturbance, IsRanked) {
  AttitudeModel model = with(bench_model(), added, "torque_N_m = 2e-4");
  const PlatformState state = state_of(model, Quat::Identity(), Vec3::Zero(), 0.0, 1800.0);
  const Budget budget = make_budget(model, state);
  ASSERT_EQ(budget.entries.size(), 1u);
  EXPECT_EQ(budget.entries[0].kind, added);
  EXPECT_DOUBLE_EQ(budget.entries[0].torque_body_N_m.norm(), 1e-4);
}

TEST(AddedDisturbance, IsDocumented) {
  const std::vector<Key::Choice> kinds = disturbance_table().keys.front().choices;
  const auto kind = std::ranges::find(kinds, added, &Key::Choice::name);
  ASSERT_NE(kind, kinds.end());
  EXPECT_EQ(kind->what, "a torque about body x in proportion to the charge drawn");
  EXPECT_EQ(kind->note, "Tested by `diagnose`: `torque_N_m` 0.0001; needs a battery current");
}

TEST(AddedSource, IsInTheRegistry) {
  const std::vector<SourceKind> all = all_source_kinds();
  const auto kind = std::ranges::find(all, "added_source", &SourceKind::name);
  ASSERT_NE(kind, all.end());
  EXPECT_EQ(kind->make(settings_of("name = 'beam'"), {})[0].name, "beam");
}

TEST(AddedReceiver, IsInTheRegistry) {
  const std::vector<ReceiverKind> all = all_receiver_kinds();
  const auto kind = std::ranges::find(all, "added_receiver", &ReceiverKind::name);
  ASSERT_NE(kind, all.end());
  EXPECT_EQ(kind->make(settings_of(""), Scene{}).receiver->bins(), 1u);
}

TEST(AddedWriter, WritesEveryProduct) {
  Product product;
  product.quantities.push_back({"power_W", {1.0, 0.1}});
  const auto folder = std::filesystem::path(PHOTORQUE_BINARY_DIR) / "added_writer";
  std::filesystem::remove_all(folder);
  const auto paths = write_formats(product, build_provenance(), folder);
  EXPECT_THAT(paths, testing::Contains(folder / "names.added_writer"));
  EXPECT_EQ(std::filesystem::file_size(folder / "names.added_writer"), 8u);
}

}  // namespace
}  // namespace photorque
