// Walls beside the receiver in the diagnosis of light: what they hide of an aperture and what they
// throw back, against closed forms; and readings that stray.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/constants.h"
#include "diagnosis/light/diagnose.h"
#include "diagnosis/light/model/illumination.h"
#include "diagnosis/light/model/run.h"
#include "scenes/experiment/experiment.h"
#include "tests/outside.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// A laboratory with an upright rectangular wall beside the receiver.
class LightWithWall : public testing::Test {
 protected:
  LightWithWall()
      : experiment_(resolve_experiment(read_experiment_file(folder_ / "experiment.toml"))),
        lab_(experiment_) {
    for (const auto& triangle : wall().triangles) {
      for (const Vec3& corner : triangle) {
        low_ = low_.cwiseMin(corner);
        high_ = high_.cwiseMax(corner);
      }
    }
    across_ = high_.x() - low_.x() < high_.y() - low_.y() ? 0 : 1;
  }

  const LightWall& wall() const { return lab_.walls().front(); }

  fs::path folder_ = outside::reference_data("light/wall");
  Experiment experiment_;
  LightLab lab_;
  Vec3 low_ = Vec3::Constant(1e9), high_ = Vec3::Constant(-1e9);
  int across_ = 0;  // the axis that is normal to the wall
};

// The wall's upper edge across the aperture at −c radii leaves the segment above it,
// π − acos c + c √(1 − c²), whose first moment is 2/3 (1 − c²)^{3/2}.
TEST_F(LightWithWall, EdgeLeavesASegmentOfTheAperture) {
  const double radius_m = 0.012;
  const Vec3 along = Vec3::Unit(1 - across_), out = Vec3::Unit(across_);
  const Vec3 edge(0.5 * (low_.x() + high_.x()), 0.5 * (low_.y() + high_.y()), high_.z());
  const Vec3 point = edge + 0.05 * out - 0.05 * Vec3::UnitZ();
  const Vec3 way = (edge - point).normalized();
  const Vec3 upward = (Vec3::UnitZ() - way.z() * way).normalized();
  const std::vector<ShadowBox> no_boxes;
  const Obstacles obstacles(lab_, no_boxes, Quat::Identity());
  for (const double c : {-0.9, -0.4, 0.0, 0.3, 0.8}) {
    const Vec3 lamp = point + 4.0 * (edge - point) + c * radius_m * upward;
    const Obstacles::Open open =
        obstacles.visible(point, lamp, radius_m * along, radius_m * upward, no_wall);
    const double root = std::sqrt(1.0 - c * c);
    EXPECT_NEAR(open.fraction, (pi - std::acos(c) + c * root) / pi, 1e-9) << c;
    EXPECT_NEAR(open.moment.x(), 0.0, 1e-9) << c;
    EXPECT_NEAR(open.moment.y(), 2.0 / 3.0 * root * root * root / pi, 1e-9) << c;
  }
  const Vec3 above = point + 4.0 * (edge - point) + 1.5 * radius_m * upward,
             below = point + 4.0 * (edge - point) - 1.5 * radius_m * upward;
  EXPECT_DOUBLE_EQ(
      obstacles.visible(point, above, radius_m * along, radius_m * upward, no_wall).fraction, 1.0);
  EXPECT_NEAR(
      obstacles.visible(point, below, radius_m * along, radius_m * upward, no_wall).fraction, 0.0,
      1e-9);
}

TEST(LightWalls, SheetsLieSideBySideAndLookOneWay) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0), above(0.5, 0.5, 0.01);
  const std::vector<std::array<Vec3, 3>> square = {{a, b, c}, {a, c, d}};
  EXPECT_TRUE(is_sheet(square));
  auto with = [&](std::initializer_list<std::array<Vec3, 3>> more) {
    auto all = square;
    all.insert(all.end(), more);
    return is_sheet(all);
  };
  EXPECT_FALSE(with({{c, b, a}, {d, c, a}}));  // both sides
  EXPECT_FALSE(with({{a, b, c}}));             // one twice
  EXPECT_FALSE(with({{a, b, d}}));             // over another
  EXPECT_FALSE(with({{b, c, above}}));         // out of the plane
  EXPECT_FALSE(is_sheet({}));
}

// From an element of the receiver to a rectangle that stands on its plane at a distance c, of
// height a and from the foot point so far b to one side: (1/2π)(atan(b/c) − c/h atan(b/h)), h² = a²
// + c² (D. Hamilton, W. Morgan, NACA TN 2836, 1952, configuration P-4).
TEST_F(LightWithWall, PlacesSeeAllOfTheWall) {
  const LightRun run(lab_, read_light_recording(folder_ / "scan1.csv.gz", {}));
  LightSites sites;
  const LightRecording& r = run.recording();
  for (size_t i = 0; i < run.rows(); i += 7) {
    sites.points_body_m.push_back(lab_.point_body_m(r.u_m[i], r.v_m[i]));
    sites.weights.push_back(1.0);
    sites.groups.push_back({sites.groups.size(), 1});
  }
  const WallExchange exchange = exchange_with(lab_, sites, 0);
  double nearest = 1e9;
  for (size_t g = 0; g < sites.groups.size(); ++g) {
    const Vec3& p = sites.points_body_m[g];
    const double c = std::abs(p[across_] - low_[across_]), a = high_.z() - p.z(),
                 h = std::hypot(a, c);
    const auto part = [&](double b) { return std::atan(b / c) - c / h * std::atan(b / h); };
    const int along = 1 - across_;
    const double expected =
        (part(high_[along] - p[along]) + part(p[along] - low_[along])) / (2.0 * pi);
    ASSERT_LE(low_.z(), p.z());
    EXPECT_NEAR(exchange.shares.row(static_cast<Eigen::Index>(g)).sum() / expected, 1.0, 5e-3)
        << p.transpose();
    nearest = std::min(nearest, c);
  }
  EXPECT_LT(nearest, 0.04);
}

// If the shadows of fields are known, only points that either shadow reaches are recomputed.
TEST_F(LightWithWall, LightBesideAKnownShadowEqualsARecomputation) {
  const LightRun run(lab_, read_light_recording(folder_ / "scan1.csv.gz", {}));
  LightState state = lab_.nominal();
  const LightFields open = run.fields(state, nullptr);
  const auto with_box = [&](double x, bool on_body) {
    LightState shaded = state;
    const Vec3 middle(x, 0.01, 0.2), half(0.02, 0.015, 0.001);
    shaded.boxes.push_back({on_body, middle - half, middle + half, 0.7});
    return shaded;
  };
  const LightState first = with_box(0.0, false), second = with_box(0.03, true);
  const LightFields of_first = run.fields(first, &open), of_second = run.fields(second, &of_first);
  const LightFields afresh = run.fields(second, nullptr);
  double moved = 0.0;
  for (size_t l = 0; l < lab_.lamps(); ++l) {
    const LampField &found = *of_second.lamps[l].field, &expected = *afresh.lamps[l].field;
    ASSERT_EQ(found, expected) << l;
    for (size_t o = 0; o < found.size(); ++o) {
      moved = std::max(moved, std::abs(found[o] - (*of_first.lamps[l].field)[o]));
    }
  }
  EXPECT_GT(moved, 1.0);
}

// One reading far off among usual ones strays; a line of them is a thing.
TEST_F(LightWithWall, SingleReadingsAreOutliers) {
  const LightRun run(lab_, read_light_recording(folder_ / "scan1.csv.gz", {}));
  const LightRecording& r = run.recording();
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Eigen::VectorXd residuals(static_cast<Eigen::Index>(run.samples()));
  for (double& x : residuals) x = normal(random);
  const size_t middle = run.rows() / 3, far = 2 * run.rows() / 3;
  residuals[static_cast<Eigen::Index>(middle)] = 6.5;
  std::vector<size_t> line;
  for (size_t i = 0; i < run.rows(); ++i) {
    const bool same_attitude = r.lab_from_body[i].coeffs() == r.lab_from_body[far].coeffs();
    if (same_attitude && r.v_m[i] == r.v_m[far]) line.push_back(i);
  }
  ASSERT_GT(line.size(), 8u);
  for (const size_t i : line) residuals[static_cast<Eigen::Index>(i)] -= 6.5;
  const std::vector<size_t> good = rows_within_noise(run, residuals);
  EXPECT_EQ(std::ranges::count(good, middle), 0);
  for (const size_t i : line) EXPECT_EQ(std::ranges::count(good, i), 1) << i;
  EXPECT_GE(good.size() + 1, run.rows());
}

}  // namespace
}  // namespace photorque
