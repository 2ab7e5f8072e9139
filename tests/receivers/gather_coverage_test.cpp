// Whether the stated errors of gathered light hold the truth as often as they should.
#include <gtest/gtest.h>

#include "receivers/gather/gather.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque {
namespace {

Gathered gathered(const TraceableScene& scene, const FluxMapReceiver& map, uint64_t seed,
                  int points) {
  const Beam lamp = fixtures::pillbox_disc("angle");
  GatherOptions options;
  options.seed = seed;
  options.points = points;
  return gather_direct(scene, {}, std::span(&lamp, 1), map, options);
}

// 1000 seeds of some thirty half-shaded bins. The truth is the same light with a thousand times as
// many shadow rays, whose own error is a fiftieth of what is judged; that it is the truth is shown
// against reference maps and against rays (gather_test.cpp).
TEST(Gather, ErrorsOfHalfShadedBinsHoldTheTruthNinetyFivePercentOfTheTime) {
  const TraceableScene scene(fixtures::shaded_square());
  Scene bare;
  fixtures::add(bare, fixtures::rectangle(Vec3::Zero(), Vec3(0.5, 0, 0), Vec3(0, 0.5, 0)),
                grey_surface("black", 0.1, 0.2), "receiver");
  const TraceableScene open_scene(std::move(bare));
  const FluxMapReceiver map = fixtures::map_of(scene.scene(), 20);
  const BinSums truth = gathered(scene, map, 1, 16384).direct;
  const BinSums open = gathered(open_scene, map, 1, 16).direct;
  // From a table, 15 degrees of freedom.
  constexpr double student_t_975 = 2.131;
  constexpr int seeds = 1000;
  std::vector<size_t> half, hardly;  // shaded bins, by entry
  for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
    const size_t entry = map.entry(bin, 0);
    const double fraction = truth.estimate(entry).value / open.estimate(entry).value;
    if (fraction > 0.01 && fraction < 0.99) half.push_back(entry);
    if (fraction >= 0.99 && fraction < 1.0 - 1e-4) hardly.push_back(entry);
  }
  ASSERT_GT(half.size(), 20u);
  ASSERT_GT(hardly.size(), 0u);
  double held = 0.0, held_by_less = 0.0, near = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    const BinSums one = gathered(scene, map, 1000 + static_cast<uint64_t>(seed), 16).direct;
    for (const size_t entry : half) {
      const Estimate found = one.estimate(entry);
      const double error = std::abs(found.value - truth.estimate(entry).value);
      const double reach = student_t_975 * found.standard_error;
      held += error <= reach;
      held_by_less += error <= 0.8 * reach;
    }
    // Where one point in some hundred is shaded, none may be seen, and the scatter says too little:
    // but then there is little to be wrong about.
    for (const size_t entry : hardly) {
      const double exact = truth.estimate(entry).value;
      near += std::abs(one.estimate(entry).value - exact) < 0.01 * exact;
    }
  }
  const double bins = seeds * static_cast<double>(half.size());
  RecordProperty("share_held", std::to_string(held / bins));
  EXPECT_NEAR(held / bins, 0.95, 0.015);
  EXPECT_LT(held_by_less / bins, 0.935);
  EXPECT_GT(near, 0.95 * seeds * static_cast<double>(hardly.size()));
}

}  // namespace
}  // namespace photorque
