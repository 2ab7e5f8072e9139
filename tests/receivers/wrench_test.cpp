#include "receivers/wrench/wrench.h"

#include <gmock/gmock.h>

#include <random>

#include "receiver_scenes.h"

namespace photorque {
namespace {

using fixtures::add_instance;
using fixtures::HitMaker;
using fixtures::plate;
using fixtures::quantity_named;
using fixtures::sums_of;
using ::testing::ElementsAre;

HitMaker push(uint32_t instance, const Vec3& position_m, const Vec3& force_N) {
  HitMaker hit;
  hit.instance = instance;
  hit.position_m = position_m;
  hit.force_N = force_N;
  return hit;
}

Scene three_parts() {
  Scene scene;
  add_instance(scene, plate(0, 1, 0, 1), "platform/top");
  add_instance(scene, plate(0, 1, 0, 1), "platform/left/mass");
  add_instance(scene, plate(0, 1, 0, 1), "platform/right/mass");
  return scene;
}

std::vector<HitMaker> random_pushes(uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<HitMaker> hits;
  for (int i = 0; i < count; ++i) {
    const Vec3 position(normal(random), normal(random), normal(random));
    const Vec3 force(normal(random), normal(random), normal(random));
    hits.push_back(push(static_cast<uint32_t>(random() % 3), position, force));
  }
  return hits;
}

TEST(WrenchReceiver, ForceAndLeverByHand) {
  // 2 N along y at x = 3 m: 6 N m about z at the origin; about (1, 0, 0) 4 N m.
  const Scene scene = three_parts();
  const std::vector<HitMaker> hits = {push(0, {3, 0, 0}, {0, 2, 0})};
  const WrenchReceiver origin("w", scene, {0, 1, 2});
  const WrenchEstimate at_origin = origin.total(sums_of(origin, {hits, hits}));
  EXPECT_EQ(at_origin.mean.force_N, Vec3(0, 2, 0));
  EXPECT_EQ(at_origin.mean.torque_N_m, Vec3(0, 0, 6));
  const WrenchReceiver shifted("w", scene, {0, 1, 2}, {1, 0, 0});
  const WrenchEstimate at_shift = shifted.total(sums_of(shifted, {hits, hits}));
  EXPECT_EQ(at_shift.mean.torque_N_m, Vec3(0, 0, 4));
  EXPECT_EQ(at_shift.mean.about_m, Vec3(1, 0, 0));
}

TEST(WrenchReceiver, ScoringAboutAnotherPointIsMovingTheWrenchThere) {
  // Means and errors alike: the covariance moves with the point.
  const Scene scene = three_parts();
  const Vec3 point_m(0.7, -1.3, 2.1);
  const std::vector<std::vector<HitMaker>> replicates = {
      random_pushes(1, 50), random_pushes(2, 50), random_pushes(3, 50), random_pushes(4, 50)};
  const WrenchReceiver origin("w", scene, {0, 1, 2}), there("w", scene, {0, 1, 2}, point_m);
  const WrenchEstimate moved = wrench_about(origin.total(sums_of(origin, replicates)), point_m);
  const WrenchEstimate scored = there.total(sums_of(there, replicates));
  EXPECT_LT((moved.mean.torque_N_m - scored.mean.torque_N_m).norm(), 1e-12);
  EXPECT_LT((moved.torque_error_N_m() - scored.torque_error_N_m()).norm(), 1e-12);
  EXPECT_GT(scored.torque_error_N_m().minCoeff(), 0.1);
}

TEST(WrenchReceiver, PartsSumToTheTotal) {
  const Scene scene = three_parts();
  const WrenchReceiver receiver("w", scene, {0, 1, 2});
  const BinSums sums = sums_of(receiver, {random_pushes(5, 200), random_pushes(6, 200)});
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (const WrenchEstimate& part : receiver.by_part(sums)) {
    force += part.mean.force_N;
    torque += part.mean.torque_N_m;
  }
  EXPECT_LT((force - receiver.total(sums).mean.force_N).norm(), 1e-12);
  EXPECT_LT((torque - receiver.total(sums).mean.torque_N_m).norm(), 1e-12);
}

TEST(WrenchReceiver, OnlyChosenInstancesCount) {
  const Scene scene = three_parts();
  const WrenchReceiver receiver("w", scene, {2, 0});
  std::vector<HitMaker> hits;
  for (const uint32_t instance : {0u, 1u, 1u, 2u, 0u}) {
    hits.push_back(push(instance, {0, 0, 0}, {std::pow(10.0, instance), 0, 0}));
  }
  const BinSums sums = sums_of(receiver, {hits, hits});
  EXPECT_EQ(receiver.total(sums).mean.force_N.x(), 102.0);
  EXPECT_EQ(receiver.by_part(sums)[0].mean.force_N.x(), 100.0);
  EXPECT_EQ(receiver.by_part(sums)[1].mean.force_N.x(), 2.0);
}

TEST(WrenchReceiver, PartNamesAreUnique) {
  Scene scene = three_parts();
  EXPECT_THAT(WrenchReceiver("w", scene, {0, 1}).part_names(), ElementsAre("top", "mass"));
  EXPECT_THAT(WrenchReceiver("w", scene, {1, 2}).part_names(),
              ElementsAre("platform/left/mass", "platform/right/mass"));
  scene.instances.push_back(scene.instances[0]);
  scene.instances[0].material = "glass";
  scene.instances[3].material = "steel";
  EXPECT_THAT(WrenchReceiver("w", scene, {0, 3}).part_names(),
              ElementsAre("platform/top:glass", "platform/top:steel"));
  scene.instances[3].material = "glass";
  EXPECT_THAT(WrenchReceiver("w", scene, {0, 3}).part_names(),
              ElementsAre("platform/top#0", "platform/top#3"));
}

TEST(WrenchReceiver, ErrorsFromReplicatesByHand) {
  // 1, 2, 6 N in three replicates: 3 ± √(7/3) N; at x = 2 m twice that about z.
  const Scene scene = three_parts();
  const WrenchReceiver receiver("w", scene, {0});
  const Product product = receiver.product(sums_of(receiver, {{push(0, {2, 0, 0}, {0, 1, 0})},
                                                              {push(0, {2, 0, 0}, {0, 2, 0})},
                                                              {push(0, {2, 0, 0}, {0, 6, 0})}}));
  const Estimate force = quantity_named(product, "force_y_w_body_N");
  const Estimate torque = quantity_named(product, "torque_z_w_body_N_m");
  EXPECT_NEAR(force.value, 3.0, 1e-14);
  EXPECT_NEAR(force.standard_error, std::sqrt(7.0 / 3.0), 1e-14);
  EXPECT_NEAR(torque.value, 6.0, 1e-14);
  EXPECT_NEAR(torque.standard_error, 2 * std::sqrt(7.0 / 3.0), 1e-14);
}

TEST(WrenchReceiver, ProductHasARowPerPartAndTheTotal) {
  const Scene scene = three_parts();
  const WrenchReceiver receiver("arm", scene, {0, 1});
  const std::vector<HitMaker> hits = {push(0, {0, 0, 1}, {1, 0, 0}), push(1, {0, 0, 2}, {1, 0, 0})};
  const Product product = receiver.product(sums_of(receiver, {hits, hits}));
  ASSERT_EQ(product.tables.size(), 1u);
  const Table& table = product.tables[0];
  EXPECT_EQ(table.name, "wrench_arm");
  EXPECT_THAT(table.columns[0].texts, ElementsAre("top", "mass", "total"));
  EXPECT_EQ(table.columns[1].name, "force_x_N");
  EXPECT_THAT(table.columns[1].values, ElementsAre(1.0, 1.0, 2.0));
  EXPECT_EQ(table.columns[5].name, "torque_y_N_m");
  EXPECT_THAT(table.columns[5].values, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_EQ(table.columns.size(), 13u);
}

}  // namespace
}  // namespace photorque
