// Markers that are not where the pose takes them to be: recordings from images of such markers, by
// a pinhole and a least-squares pose of this file's own, which share nothing with the law.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "attitude/camera/pose.h"
#include "attitude/model/dynamics.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/diagnosis/named.h"
#include "tests/diagnosis/noisy_recording.h"
#include "tests/noise.h"

namespace photorque {
namespace {

using namespace rigid_body;
using testing::ElementsAre;
using testing::HasSubstr;
using Board = std::vector<Vec3>;

Board stated_m() {
  Board board;
  for (const Marker& marker : bench_camera().markers) board.push_back(marker.position_body_m);
  return board;
}

// One marker aside.
Board one_off_m(size_t marker, const Vec3& by_m) {
  Board errors(5, Vec3::Zero());
  errors[marker] = by_m;
  return errors;
}

// All of them, a fifth of a millimetre, drawn.
Board all_off_m(unsigned seed) {
  Noise normal(seed, 2e-4);
  Board errors;
  for (size_t i = 0; i < 5; ++i) {
    const double x = normal(), y = normal(), z = normal();
    errors.emplace_back(x, y, z);
  }
  return errors;
}

// A pinhole one metre above the centre of rotation, in pixels.
Vec2 pinhole_image(const Quat& lab_from_body, const Vec3& point_m) {
  constexpr double focal_px = 8e-3 / 4.8e-6;
  const Vec3 lab_m = lab_from_body * point_m;
  return focal_px / (1.0 - lab_m.z()) * lab_m.head<2>();
}

Quat turned_by(const Quat& q, const Vec3& turn) {
  return turn.norm() > 0.0 ? q * Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) : q;
}

// Gauss and Newton, derivatives by differences: the pose of markers where they are stated from the
// images of the true ones, all weighing the same.
Quat pose_from(const Quat& truth, const Board& errors) {
  const Board board = stated_m();
  Quat pose = truth;
  for (int round = 0; round < 6; ++round) {
    Mat3 normal = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (size_t i = 0; i < board.size(); ++i) {
      const Vec2 off = pinhole_image(truth, board[i] + errors[i]) - pinhole_image(pose, board[i]);
      Eigen::Matrix<double, 2, 3> slope;
      constexpr double step = 1e-6;
      for (int k = 0; k < 3; ++k) {
        slope.col(k) = (pinhole_image(turned_by(pose, step * Vec3::Unit(k)), board[i]) -
                        pinhole_image(turned_by(pose, -step * Vec3::Unit(k)), board[i])) /
                       (2.0 * step);
      }
      normal += slope.transpose() * slope;
      right += slope.transpose() * off;
    }
    pose = turned_by(pose, normal.ldlt().solve(right));
  }
  return pose;
}

Vec3 turn_seen(const Quat& truth, const Board& errors) {
  const Eigen::AngleAxisd turn(truth.conjugate() * pose_from(truth, errors));
  return turn.angle() * turn.axis();
}

// The rotation by these errors according to the law.
Vec3 turn_by_law(const TrackingCamera& camera, const Quat& attitude, const Board& errors) {
  AttitudeModel model = bench_model();
  std::vector<double> all;
  for (const Vec3& e : errors) all.insert(all.end(), {e.x(), e.y(), e.z()});
  model.disturbances = {make_disturbance_of("marker_positions", {{"error_m", all}},
                                            {model.platform, model.environment, &camera})};
  const Dynamics dynamics(model);
  const std::vector<double> y = to_vector(state_of(model, attitude));
  const std::vector<Lanes> lanes(y.begin(), y.end());
  std::array<ZeroOrderHold, Lanes::count> held;
  held.fill(model.schedule.at(0.0));
  const Vec3Of<Lanes> turn = dynamics.at(Lanes(0.0), held, lanes.data()).camera_error_rad;
  return {turn[0][0], turn[1][0], turn[2][0]};
}

Quat board_leaning(double tilt_rad, double heading_rad) {
  return lab_from_body_at(tilt_rad, heading_rad).rotation;
}

constexpr double tilts_rad[] = {0.0, 0.1, 0.25, 0.5};
constexpr double headings_rad[] = {0.0, 1.1, 2.5, -0.7};

// As solvers do that know no errors.
TrackingCamera camera_of_equals() {
  TrackingCamera camera = bench_camera();
  camera.weighs_alike = true;
  return camera;
}

TEST(MarkerPositions, RotateThePoseAsInTheLaw) {
  const Board errors = all_off_m(3);
  const TrackingCamera camera = camera_of_equals();
  for (const double tilt : tilts_rad) {
    for (const double heading : headings_rad) {
      const Quat q = board_leaning(tilt, heading);
      const Vec3 found = turn_seen(q, errors), law = turn_by_law(camera, q, errors);
      EXPECT_LT((found - law).norm(), 1e-5) << tilt << ", " << heading;
    }
  }
}

// The camera's own pose (weighed by Fisher's information of every spot), about a known
// centre and free.
TEST(MarkerPositions, RotateTheCamerasPoseAsInTheLaw) {
  for (const bool knows_centre : {true, false}) {
    TrackingCamera camera = bench_camera();
    camera.knows_centre = knows_centre;
    camera.marker_error_body_m = all_off_m(4);
    for (const double tilt : tilts_rad) {
      if (!knows_centre && tilt < 0.2) continue;  // a flat board from afar hardly fixes it there
      for (const double heading : headings_rad) {
        const Quat q = board_leaning(tilt, heading);
        const auto found = marker_bias_lab_rad(camera, {q, Vec3::Zero(), Vec3::Zero()});
        ASSERT_TRUE(found);
        const Vec3 law = q * turn_by_law(camera, q, camera.marker_error_body_m);
        EXPECT_LT((*found - law).norm(), 0.01 * found->norm())
            << knows_centre << ", " << tilt << ", " << heading;
      }
    }
  }
}

// Images with noise, read and solved: the deviation of their mean is that of the law.
TEST(MarkerPositions, TurnTheMeanOfNoisyImages) {
  TrackingCamera camera = bench_camera();
  camera.marker_error_body_m = one_off_m(2, {0, 0, 4e-4});
  const Pose pose{board_leaning(0.25, 0.4), Vec3::Zero(), Vec3::Zero()};
  const auto covariance = attitude_covariance_lab_rad2(camera, pose);
  ASSERT_TRUE(covariance);
  constexpr int images = 2000;
  const ImageStatistics seen = take_images(camera, pose, images, 5, *covariance);
  const Vec3 off = seen.mean_rad - pose.lab_from_body * turn_by_law(camera, pose.lab_from_body,
                                                                    camera.marker_error_body_m);
  EXPECT_LT(off.dot(covariance->inverse() * off) * images, 21.1);  // χ² of 3, one in 10⁴
  EXPECT_GT(seen.mean_rad.dot(covariance->inverse() * seen.mean_rad) * images, 1000.0);
}

NominalModel model_with_camera() {
  NominalModel nominal = nominal_model();
  Sensors::Camera& camera = nominal.sensors.camera.emplace();
  camera.geometry = camera_of_equals();
  nominal.sensors.gyro.emplace().noise_rad_s = 2e-4;
  return nominal;
}

NamedRecording seen_by(NamedRecording r, const Board& errors) {
  for (size_t row = 0; row < r.recording.time_s.size(); ++row) {
    std::vector<Channel>& c = r.recording.channels;
    const Quat truth(c[0].values[row], c[1].values[row], c[2].values[row], c[3].values[row]);
    const Quat seen = pose_from(truth.normalized(), errors);
    const double parts[] = {seen.w(), seen.x(), seen.y(), seen.z()};
    for (size_t k = 0; k < 4; ++k) c[k].values[row] = parts[k];
  }
  return r;
}

Session four_minutes() {
  Session session;
  session.duration_s = 240.0;
  session.interval_s = 0.2;
  return session;
}

Diagnosis diagnosed_board(const Board& errors) {
  return diagnose(model_with_camera(),
                  {seen_by(recorded_with(1, four_minutes(), nothing_more), errors)},
                  {seen_by(recorded_with(2, four_minutes(), nothing_more), errors)});
}

TEST(MarkerPositions, TheOneThatIsOffIsNamedAndMeasured) {
  const Vec3 off_m(3e-4, -2e-4, 4e-4);
  const Diagnosis d = diagnosed_board(one_off_m(3, off_m));
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d), ElementsAre("marker_positions")) << d.sentence;
  const std::vector<FittedParameter>& found = d.effects[0].parameters;
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].key, "marker");
  EXPECT_THAT(found[0].value, ElementsAre(4.0));
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(found[1].value[k], off_m[static_cast<Eigen::Index>(k)], 4.0 * found[1].sigma[k]);
    EXPECT_LT(found[1].sigma[k], 0.2 * off_m.norm());
  }
  EXPECT_THAT(d.sentence, HasSubstr("marker 4"));
  EXPECT_LT(d.holdout->chi2_per_sample_after, 1.25);
}

TEST(MarkerPositions, AllThatAreOffAreNamedTogether) {
  const Diagnosis d = diagnosed_board(all_off_m(3));
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d), ElementsAre("marker_positions")) << d.sentence;
  ASSERT_EQ(d.effects[0].parameters.size(), 1u);
  EXPECT_EQ(d.effects[0].parameters[0].value.size(), 15u);
  EXPECT_LT(d.holdout->chi2_per_sample_after, 1.1);
}

// Boards without errors, and one that is turned as a whole, are not called so.
TEST(MarkerPositions, AreNotNamedWhereTheBoardIsRight) {
  const Diagnosis nothing = diagnosed_board(Board(5, Vec3::Zero()));
  EXPECT_EQ(nothing.verdict, Verdict::consistent) << nothing.sentence;
  Board turned_board;
  for (const Vec3& m : stated_m()) turned_board.push_back(Vec3(1e-3, -2e-3, 1.5e-3).cross(m));
  const Diagnosis turned = diagnosed_board(turned_board);
  EXPECT_THAT(kinds_of(turned), ElementsAre("camera_misalignment")) << turned.sentence;
}

}  // namespace
}  // namespace photorque
