#include "core/snapshot.h"

#include <gtest/gtest.h>

#include <deque>
#include <limits>

namespace photorque {
namespace {

// One of everything that a state is made of.
struct Walk {
  int64_t steps = 0;
  double where_m = 0.0;
  bool is_lost = false;
  std::string name;
  std::vector<double> path_m;
  std::optional<double> goal_m;
  struct Meeting {
    std::string whom;
    double when_s = 0.0;
  };
  std::deque<Meeting> meetings;

  void keep(Snapshot& snapshot) {
    snapshot(steps, where_m, is_lost, name, path_m, goal_m);
    snapshot.each(meetings, [&](Meeting& one) { snapshot(one.whom, one.when_s); });
  }
};

std::string bytes_of(Walk walk) {
  Snapshot snapshot;
  walk.keep(snapshot);
  return snapshot.bytes();
}

Walk walked() {
  return {.steps = 7,
          .where_m = -0.0,
          .is_lost = true,
          .name = "walk",
          .path_m = {0.1, std::numeric_limits<double>::denorm_min()},
          .goal_m = 3.5,
          .meetings = {{"a friend", 1.5}, {"", -2.0}}};
}

TEST(Snapshot, RestoresTheStoredState) {
  const std::string bytes = bytes_of(walked());
  Walk back{.name = "another", .path_m = {1, 2, 3}, .goal_m = {}, .meetings = {{"nobody", 0.0}}};
  Snapshot snapshot(bytes);
  snapshot(back);
  EXPECT_TRUE(snapshot.is_whole());
  EXPECT_EQ(back.steps, 7);
  EXPECT_TRUE(std::signbit(back.where_m));
  EXPECT_TRUE(back.is_lost);
  EXPECT_EQ(back.name, "walk");
  EXPECT_EQ(back.path_m, walked().path_m);
  EXPECT_EQ(back.goal_m, 3.5);
  ASSERT_EQ(back.meetings.size(), 2u);
  EXPECT_EQ(back.meetings[0].whom, "a friend");
  EXPECT_EQ(back.meetings[1].when_s, -2.0);
}

TEST(Snapshot, ReportsMissingAndSurplusBytes) {
  const std::string bytes = bytes_of(walked());
  for (size_t size = 0; size < bytes.size(); ++size) {
    const std::string part = bytes.substr(0, size);
    Walk back;
    Snapshot snapshot(part);
    snapshot(back);
    EXPECT_FALSE(snapshot.is_whole()) << size;
  }
  const std::string more = bytes + "x";
  Walk back;
  Snapshot snapshot(more);
  snapshot(back);
  EXPECT_FALSE(snapshot.is_whole());
}

// Lengths that no bytes stand for must not be trusted.
TEST(Snapshot, TakesNoMemoryForLengthsBeyondItsBytes) {
  uint64_t length = uint64_t{1} << 60;
  Snapshot taken;
  taken(length);
  std::vector<double> numbers;
  Snapshot of_numbers(taken.bytes());
  of_numbers(numbers);
  EXPECT_FALSE(of_numbers.is_whole());
  EXPECT_TRUE(numbers.empty());
  std::vector<Walk::Meeting> meetings;
  Snapshot of_a_list(taken.bytes());
  of_a_list.each(meetings, [&](Walk::Meeting& one) { of_a_list(one.whom, one.when_s); });
  EXPECT_FALSE(of_a_list.is_whole());
  EXPECT_LE(meetings.size(), 1u);
}

TEST(Snapshot, RejectsUndeterminedQuantities) {
  Snapshot taken;
  size_t index = 5;
  taken.expect(3);
  taken.at_most(index, 9);
  for (const auto& [length, largest] : {std::pair{3, 9}, {4, 9}, {3, 4}}) {
    Snapshot back(taken.bytes());
    size_t given = 0;
    back.expect(static_cast<uint64_t>(length));
    back.at_most(given, static_cast<uint64_t>(largest));
    EXPECT_EQ(back.is_whole(), length == 3 && largest == 9);
    EXPECT_LE(given, static_cast<size_t>(largest));
  }
}

}  // namespace
}  // namespace photorque
