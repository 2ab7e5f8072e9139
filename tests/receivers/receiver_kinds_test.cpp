// Laws that hold for every registered kind of receiver.
#include <gmock/gmock.h>

#include <random>

#include "receiver_scenes.h"
#include "receivers/kind.h"
#include "tests/refusal.h"
#include "tests/settings.h"

namespace photorque {
namespace {

using fixtures::add_instance;
using fixtures::HitMaker;
using fixtures::hits_of;
using fixtures::plate;
using fixtures::sums_of;
using test::numbers_node;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Scene two_plates() {
  Scene scene;
  add_instance(scene, plate(-1, 1, -1, 1), "platform/solar_array");
  add_instance(scene, plate(-1, 1, -1, 1, -0.5), "platform/bottom");
  return scene;
}

std::vector<HitMaker> random_hits(uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<HitMaker> hits;
  for (int i = 0; i < count; ++i) {
    HitMaker hit;
    hit.instance = static_cast<uint32_t>(random() % 2);
    hit.front = random() % 4 != 0;
    hit.position_m = {uniform(random), uniform(random), hit.instance == 0 ? 0.0 : -0.5};
    hit.incident_W = {uniform(random) + 1.5};
    hit.absorbed_W = {0.5 * hit.incident_W[0]};
    hit.force_N = Vec3(uniform(random), uniform(random), uniform(random)) * 1e-9;
    hits.push_back(hit);
  }
  return hits;
}

Settings settings_of(SettingsNode::Table table) {
  return test::settings_of(std::move(table), "receiver[0]");
}

Settings on_array() {
  return settings_of({{"node", {"solar_array"}}});
}

class EveryReceiver : public ::testing::TestWithParam<ReceiverKind> {};

TEST_P(EveryReceiver, AddsBatchesInAnyGrouping) {
  const auto receiver = GetParam().make(on_array(), two_plates()).receiver;
  const std::vector<HitMaker> all = random_hits(3, 250);
  std::vector<double> whole(receiver->bins(), 0.0), parts(receiver->bins(), 0.0);
  receiver->score(*hits_of(all), whole);
  receiver->score(*hits_of({all.begin() + 80, all.end()}), parts);
  receiver->score(*hits_of({all.begin(), all.begin() + 80}), parts);
  double largest = 0.0;
  for (const double bin : whole) largest = std::max(largest, std::abs(bin));
  ASSERT_GT(largest, 0.0);
  for (size_t bin = 0; bin < whole.size(); ++bin) {
    ASSERT_NEAR(whole[bin], parts[bin], 1e-13 * largest);
  }
}

TEST_P(EveryReceiver, IsLinearInTheHits) {
  const auto receiver = GetParam().make(on_array(), two_plates()).receiver;
  std::vector<HitMaker> hits = random_hits(4, 250);
  std::vector<double> once(receiver->bins(), 0.0), doubled(receiver->bins(), 0.0);
  receiver->score(*hits_of(hits), once);
  for (HitMaker& hit : hits) {
    hit.incident_W[0] *= 2;
    hit.absorbed_W[0] *= 2;
    hit.force_N *= 2;
  }
  receiver->score(*hits_of(hits), doubled);
  for (size_t bin = 0; bin < once.size(); ++bin) ASSERT_EQ(doubled[bin], 2 * once[bin]);
}

TEST_P(EveryReceiver, ProductIsWhole) {
  const auto receiver = GetParam().make(on_array(), two_plates()).receiver;
  const BinSums sums =
      sums_of(*receiver, {random_hits(5, 250), random_hits(6, 250), random_hits(7, 250)});
  const Product product = receiver->product(sums);
  EXPECT_FALSE(product.quantities.empty());
  for (const Quantity& quantity : product.quantities) {
    EXPECT_TRUE(std::isfinite(quantity.estimate.value)) << quantity.name;
    EXPECT_GE(quantity.estimate.standard_error, 0.0) << quantity.name;
    EXPECT_THAT(quantity.name, HasSubstr("solar_array"));
  }
  for (const Map& map : product.maps) {
    EXPECT_EQ(map.value.size(), static_cast<size_t>(map.width) * static_cast<size_t>(map.height));
    EXPECT_EQ(map.standard_error.size(), map.value.size());
    EXPECT_THAT(map.name, HasSubstr("solar_array"));
  }
  for (const Table& table : product.tables) {
    for (const Table::Column& column : table.columns) {
      EXPECT_EQ(std::max(column.values.size(), column.texts.size()),
                table.columns.front().texts.size());
    }
  }
}

TEST_P(EveryReceiver, IsDarkWithoutLight) {
  const auto receiver = GetParam().make(on_array(), two_plates()).receiver;
  for (const Quantity& quantity : receiver->product(sums_of(*receiver, {{}, {}})).quantities) {
    if (quantity.name.starts_with("area")) continue;
    EXPECT_EQ(quantity.estimate.value, 0.0) << quantity.name;
    EXPECT_EQ(quantity.estimate.standard_error, 0.0) << quantity.name;
  }
}

TEST_P(EveryReceiver, NamesTheNearestNode) {
  const std::string message = refusal_of([&] {
    GetParam().make(settings_of({{"node", {"solar_aray"}}}), two_plates());
  });
  EXPECT_THAT(message, AllOf(HasSubstr("test.toml:7: receiver[0].node"), HasSubstr("solar_aray"),
                             HasSubstr("perhaps \"solar_array\""), HasSubstr("bottom"),
                             Not(HasSubstr("\n"))));
}

TEST_P(EveryReceiver, ReadsEveryDeclaredKeyAndNoOther) {
  const Settings settings =
      settings_of({{"node", {"solar_array"}}, {"name", {"wing 1/left"}}, {"colour", {"red"}}});
  const auto receiver = GetParam().make(settings, two_plates()).receiver;
  EXPECT_THAT(refusal_of([&] { settings.finish(); }), HasSubstr("colour"));
  const Product product = receiver->product(sums_of(*receiver, {{}, {}}));
  EXPECT_THAT(product.quantities.front().name, HasSubstr("wing_1_left"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryReceiver, ::testing::ValuesIn(all_receiver_kinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST(ReceiverSettings, GridKeysAreChecked) {
  const ReceiverKind kind = all_receiver_kinds().front();
  ASSERT_EQ(kind.name, "flux_map");
  const auto message = [&](const std::string& key, const SettingsNode& value) {
    return refusal_of([&] {
      kind.make(settings_of({{"node", {"bottom"}}, {key, value}}), two_plates());
    });
  };
  EXPECT_THAT(message("bins", numbers_node({0, 100})), HasSubstr("1 to 4096"));
  EXPECT_THAT(message("bins", numbers_node({10, 10.5})), HasSubstr("10.5"));
  EXPECT_THAT(message("bins", numbers_node({10, 5000})), HasSubstr("5000"));
  EXPECT_THAT(message("bins", numbers_node({10})), HasSubstr("two whole numbers"));
  EXPECT_THAT(message("over", {"sphere"}), HasSubstr("\"uv\""));
  EXPECT_THAT(message("side", {"bak"}), HasSubstr("did you mean \"back\""));
  EXPECT_THAT(message("facing", numbers_node({0, 0, 0})), HasSubstr("direction"));
  EXPECT_THAT(message("facing", numbers_node({0, 0, -1})),
              HasSubstr("test.toml:7: receiver[0]: found no surface that faces that way"));
  EXPECT_THAT(message("name", {""}), HasSubstr("empty"));
  EXPECT_EQ(message("bins", numbers_node({4096, 1})), "");
}

}  // namespace
}  // namespace photorque
