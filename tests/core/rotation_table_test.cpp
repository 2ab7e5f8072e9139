// Functions of attitude as tables: against the functions themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/random.h"
#include "core/numerics/table.h"
#include "core/transform.h"

namespace photorque {
namespace {

Quat random_attitude(uint64_t i) {
  const auto u = [&](uint64_t d) { return 2.0 * unit_interval(hash_words(7, i, d)) - 1.0; };
  return Quat(u(0), u(1), u(2), u(3)).normalized();
}

TEST(RotationChart, GivesBackEveryAttitude) {
  for (uint64_t i = 0; i < 1000; ++i) {
    const Quat q = random_attitude(i);
    const RotationPoint point = point_of(q);
    EXPECT_LE(std::hypot(point.x, point.y), 2.0 + 1e-12);
    EXPECT_NEAR(std::abs(rotation_at(point).dot(q)), 1.0, 1e-14);
  }
}

// On the upper half p points where the lab's up is seen from the body, and a turn about the lab's
// vertical changes the twist alone, by its angle.
TEST(RotationChart, TiltIsTheRadiusAndYawTheTwist) {
  const double tilt = 0.4, heading = 1.1, yaw = 0.7;
  const Quat tilted = lab_from_body_at(tilt, heading).rotation;
  const Quat spun(Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
  const RotationPoint point = point_of(tilted), turned = point_of(spun * tilted);
  EXPECT_NEAR(std::hypot(point.x, point.y), 2.0 * std::tan(tilt / 2), 1e-15);
  const Vec3 up_body = tilted.conjugate() * Vec3::UnitZ();
  EXPECT_NEAR(std::atan2(point.y, point.x), std::atan2(up_body.y(), up_body.x()), 1e-14);
  EXPECT_NEAR(point.twist_rad, 0.0, 1e-15);
  EXPECT_NEAR(turned.x, point.x, 1e-15);
  EXPECT_NEAR(turned.y, point.y, 1e-15);
  EXPECT_NEAR(turned.twist_rad, yaw, 1e-14);
}

TEST(RotationChart, SlopesAreThoseOfDifferences) {
  for (uint64_t i = 0; i < 50; ++i) {
    const Quat q = random_attitude(i);
    RotationSlopes slopes;
    const RotationPoint at = point_of(q, &slopes);
    const double h = 1e-6;
    for (size_t k = 0; k < 4; ++k) {
      std::array<double, 4> c = {q.w(), q.x(), q.y(), q.z()};
      c[k] += h;
      const RotationPoint next = point_of(Quat(c[0], c[1], c[2], c[3]));
      if (next.half != at.half) continue;
      EXPECT_NEAR((next.x - at.x) / h, slopes[0][k], 3e-5 * (1 + std::abs(slopes[0][k])));
      EXPECT_NEAR((next.y - at.y) / h, slopes[1][k], 3e-5 * (1 + std::abs(slopes[1][k])));
      EXPECT_NEAR((next.twist_rad - at.twist_rad) / h, slopes[2][k],
                  3e-5 * (1 + std::abs(slopes[2][k])));
    }
  }
}

using Plain = std::function<std::vector<double>(const Quat&)>;

RotationFunction exact(const Plain& plain, size_t* calls = nullptr) {
  return [plain, calls](std::span<const Quat> attitudes) {
    std::vector<RotationSample> samples;
    for (const Quat& q : attitudes) {
      const std::vector<double> value = plain(q);
      samples.push_back({value, std::vector<double>(value.size(), 0.0)});
    }
    if (calls != nullptr) *calls += attitudes.size();
    return samples;
  };
}

RotationTableOptions up_to(double angle_deg, double tolerance, size_t channels) {
  RotationTableOptions options;
  options.max_angle_rad = angle_deg * degree_rad;
  options.tolerance = tolerance;
  options.group_of_channel.assign(channels, 0);
  return options;
}

double largest_error(const RotationTable& table, const Plain& plain, double max_angle_rad) {
  double worst = 0.0;
  for (uint64_t i = 0; i < 4000; ++i) {
    const Quat q = random_attitude(100 + i);
    const Vec3 up_body = q.conjugate() * Vec3::UnitZ();
    if (up_body.z() < std::cos(max_angle_rad)) continue;
    const std::vector<double> truth = plain(q);
    std::vector<double> value(truth.size());
    table.at(q, 0, value);
    for (size_t c = 0; c < truth.size(); ++c) {
      worst = std::max(worst, std::abs(value[c] - truth[c]));
    }
  }
  return worst;
}

// Light along the vertical: the body's sight of it is all that counts.
std::vector<double> overhead(const Quat& q) {
  const Vec3 up = q.conjugate() * Vec3::UnitZ();
  return {up.x() * up.z(), std::exp(-4.0 * up.x() * up.x()), up.y()};
}

TEST(RotationTable, LightFromAboveNeedsNoYaw) {
  size_t calls = 0;
  const RotationTable table = make_rotation_table(exact(overhead, &calls), up_to(30, 1e-4, 3));
  EXPECT_EQ(table.twists(), 1u);
  EXPECT_LE(largest_error(table, overhead, 30 * degree_rad), 2e-4);
  EXPECT_LT(calls, 400u);
  EXPECT_LE(table.error().max[0], 1e-4);
}

// A lamp to one side, l in the lab: seen from the body it goes round with the yaw.
std::vector<double> sideways(const Quat& q) {
  const Vec3 l = q.conjugate() * Vec3(0.8, 0.0, 0.6);
  return {l.x() * std::max(0.0, l.z()), l.y() * l.z(), l.z() * l.z()};
}

TEST(RotationTable, LightFromOneSideNeedsYaw) {
  const RotationTable table = make_rotation_table(exact(sideways), up_to(30, 1e-4, 3));
  EXPECT_GE(table.twists(), 4u);
  EXPECT_EQ(table.fold(), 1);
  // The kink of max() is where l lies in the plate's plane, beyond 53 deg of tilt.
  EXPECT_LE(largest_error(table, sideways, 30 * degree_rad), 4e-4);
}

TEST(RotationTable, FindsAFourfoldLight) {
  const auto plain = [](const Quat& q) -> std::vector<double> {
    const RotationPoint point = point_of(q);
    return {(1.0 + point.x) * std::cos(4 * point.twist_rad) + std::sin(8 * point.twist_rad)};
  };
  const RotationTable table = make_rotation_table(exact(plain), up_to(20, 1e-4, 1));
  EXPECT_EQ(table.fold(), 4);
  EXPECT_LE(largest_error(table, plain, 20 * degree_rad), 4e-4);
}

// The whole sphere about a direction that is not the vertical, with a shadow's edge.
TEST(RotationTable, WholeSphereAndAnEdge) {
  const Vec3 sun = Vec3(1, 2, -0.5).normalized();
  const auto plain = [sun](const Quat& q) -> std::vector<double> {
    const Vec3 s = q.conjugate() * sun;
    return {std::max(0.0, s.z()) * s.x(), s.y() * s.z()};
  };
  RotationTableOptions options = up_to(180, 5e-3, 2);
  options.axis_from_lab = Quat::FromTwoVectors(sun, Vec3::UnitZ());
  const RotationTable table = make_rotation_table(exact(plain), options);
  EXPECT_EQ(table.twists(), 1u);
  double worst = 0.0;
  for (uint64_t i = 0; i < 4000; ++i) {
    const Quat q = random_attitude(i);
    std::array<double, 2> value;
    table.at(q, 0, value);
    worst = std::max(worst, std::abs(value[0] - plain(q)[0]));
  }
  EXPECT_LE(worst, 0.01);
}

TEST(RotationTable, SlopesAreThoseOfDifferences) {
  const RotationTable table = make_rotation_table(exact(sideways), up_to(30, 1e-3, 3));
  const Quat q =
      (Quat(Eigen::AngleAxisd(0.9, Vec3::UnitZ())) * lab_from_body_at(0.2, 0.3).rotation);
  std::array<double, 2> value, more;
  std::array<double, 8> slopes;
  table.at(q, 1, value, slopes);
  const double h = 1e-6;
  for (size_t k = 0; k < 4; ++k) {
    std::array<double, 4> c = {q.w(), q.x(), q.y(), q.z()};
    c[k] += h;
    table.at(Quat(c[0], c[1], c[2], c[3]), 1, more);
    EXPECT_NEAR((more[0] - value[0]) / h, slopes[k], 1e-4);
    EXPECT_NEAR((more[1] - value[1]) / h, slopes[4 + k], 1e-4);
  }
}

TEST(RotationTable, APartHoldsTheSameNumbers) {
  const RotationTable table = make_rotation_table(exact(sideways), up_to(30, 1e-3, 3));
  const RotationTable part = table.only(1, 2);
  const Quat q = lab_from_body_at(0.2, 0.3).rotation;
  std::array<double, 3> whole;
  std::array<double, 2> two, of_whole;
  table.at(q, 0, whole);
  table.at(q, 1, of_whole);
  part.at(q, 0, two);
  for (size_t c = 0; c < 2; ++c) {
    EXPECT_NEAR(two[c], whole[c + 1], 1e-15);
    EXPECT_NEAR(of_whole[c], whole[c + 1], 1e-15);
  }
}

TEST(RotationTable, BytesOfASingleLeafGiveItBack) {
  const auto constant = [](const Quat&) -> std::vector<double> { return {3.0}; };
  const RotationTable table = make_rotation_table(exact(constant), up_to(10, 1e-3, 1));
  EXPECT_EQ(table.leaves(), 1u);
  RotationTable again;
  EXPECT_TRUE(again.read(table.bytes()));
}

TEST(RotationTable, BytesGiveItBackAndOthersAreRefused) {
  const RotationTable table = make_rotation_table(exact(sideways), up_to(30, 1e-3, 3));
  const std::string bytes = table.bytes();
  RotationTable again;
  ASSERT_TRUE(again.read(bytes));
  EXPECT_EQ(again.bytes(), bytes);
  std::array<double, 3> a, b;
  table.at(lab_from_body_at(0.1, 1.0).rotation, 0, a);
  again.at(lab_from_body_at(0.1, 1.0).rotation, 0, b);
  EXPECT_EQ(a, b);
  EXPECT_FALSE(again.read(bytes.substr(0, bytes.size() - 3)));
  EXPECT_FALSE(again.read("nonsense"));
}

// Found by reading and by fuzzing: sums that wrapped round let places beyond the table through, and
// a box among its own children was followed without end.
TEST(RotationTable, BytesThatPointElsewhereAreRefused) {
  const std::string bytes = make_rotation_table(exact(sideways), up_to(30, 1e-3, 3)).bytes();
  constexpr size_t first_box = 88, first_sample = first_box + 48, children = first_box + 148;
  const auto with = [&](size_t at, uint32_t word) {
    std::string changed = bytes;
    std::memcpy(changed.data() + at, &word, sizeof word);
    return changed;
  };
  RotationTable table;
  uint32_t there = 0;
  std::memcpy(&there, bytes.data() + children, sizeof there);
  EXPECT_TRUE(table.read(with(children, there)));
  for (const uint32_t place : {0xffffffffu, 0x7fffffffu, 100000u}) {
    EXPECT_FALSE(table.read(with(first_sample, place))) << place;
  }
  for (const uint32_t place : {0x7ffffffeu, 0x7fffffffu, 0u, 100000u}) {
    EXPECT_FALSE(table.read(with(children, place))) << place;
  }
  constexpr size_t channels = 40;
  EXPECT_FALSE(table.read(with(channels + 4, 0x7fffffffu)));
}

// Found by fuzzing: a number that no integer holds was cut off to one that it does.
TEST(RotationTable, RepeatsOfATurnThatAreNoneAreRefused) {
  const std::string bytes = make_rotation_table(exact(sideways), up_to(30, 1e-3, 3)).bytes();
  constexpr size_t fold = 64;
  for (const int64_t repeats : {int64_t{0}, int64_t{-3}, int64_t{1} << 32 | 1, int64_t{1} << 62}) {
    std::string changed = bytes;
    std::memcpy(changed.data() + fold, &repeats, sizeof repeats);
    EXPECT_FALSE(RotationTable().read(changed)) << repeats;
  }
}

TEST(RotationTable, BeyondItsEdgeIsAnError) {
  const RotationTable table = make_rotation_table(exact(overhead), up_to(20, 1e-3, 3));
  std::array<double, 3> value;
  EXPECT_NO_THROW(table.at(lab_from_body_at(20 * degree_rad, 2.0).rotation, 0, value));
  EXPECT_THROW(table.at(lab_from_body_at(40 * degree_rad, 0.0).rotation, 0, value), NumericalError);
}

}  // namespace
}  // namespace photorque
