#include "attitude/camera/tracking_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "attitude/camera/pose.h"
#include "attitude/recordings/sensors.h"
#include "core/constants.h"
#include "core/transform.h"
#include "tests/attitude/settings_bench.h"

namespace photorque {
namespace {

// The cross of five markers of scenes/stasis/camera.toml, seen from above.
TrackingCamera cross_camera() {
  TrackingCamera camera;
  const double a = 0.08075, z = 0.0255;
  for (const Vec3& p :
       {Vec3(0, 0, z), Vec3(a, 0, z), Vec3(0, a, z), Vec3(-a, 0, z), Vec3(0, -a, z)})
    camera.markers.push_back({p, Vec3::UnitZ(), true});
  camera.radiant_intensity_W_sr = 1.7e-5;
  camera.exposure_s = 45e-6;
  camera.lab_from_camera = frame_looking_along({0, 0, -1}, {0, 0, 1});
  return camera;
}

Pose leaning_by(double tilt_deg, double heading_deg) {
  return {lab_from_body_at(tilt_deg * degree_rad, heading_deg * degree_rad).rotation, Vec3::Zero(),
          Vec3::Zero()};
}

// Only Poisson noise: σ²/N for a spot that is large relative to its pixels (R. Thompson, D. Larson,
// W. Webb, Biophys. J. 82 (2002) 2775, eq. 9). Pixels add a twelfth of a pixel² to σ².
TEST(SpotCentre, IsAsGoodAsItsPhotons) {
  const Spot spot{{20.3, 17.8}, 2e6, 3.0, Vec2::Zero()};
  const Mat2 covariance = centre_covariance_px2(spot, {0.0, 1e-3, 1e300});
  const double expected = (9.0 + 1.0 / 12.0) / 2e6;
  EXPECT_NEAR(covariance(0, 0) / expected, 1.0, 5e-3);
  EXPECT_NEAR(covariance(1, 1) / expected, 1.0, 5e-3);
  EXPECT_NEAR(covariance(0, 1) / expected, 0.0, 1e-3);
}

// Only a background b per pixel: 8πσ⁴ b/N², as for a fitted Gaussian (the same source, eq. 14).
TEST(SpotCentre, UnderABackgroundIsAsGoodAsAFittedGaussian) {
  const Spot spot{{20.0, 20.0}, 1e4, 3.0, Vec2::Zero()};
  const double b = 1e7;
  const Mat2 covariance = centre_covariance_px2(spot, {b, 1e-3, 1e300});
  const double expected = 8.0 * pi * std::pow(9.0 + 1.0 / 12.0, 2) * b / 1e8;
  EXPECT_NEAR(covariance(0, 0) / expected, 1.0, 0.01);
}

// In a long uniform line of light along x, only the ends carry information on x: the centre is less
// certain along the line than across it.
TEST(SpotCentre, SuffersFromMotionAlongItAlone) {
  const Spot still{{20.0, 20.0}, 1e5, 1.0, Vec2::Zero()};
  Spot moved = still;
  moved.smear_px = {6.0, 0.0};
  const PixelNoise noise{0.0, 1.0, 1e300};
  const Mat2 before = centre_covariance_px2(still, noise),
             after = centre_covariance_px2(moved, noise);
  EXPECT_GT(after(0, 0), 2.0 * before(0, 0));
  EXPECT_NEAR(after(1, 1) / before(1, 1), 1.0, 0.1);
}

// Values of OpenCV 4.6.0: cv2.projectPoints of points in the camera's frame, with the camera matrix
// of a focal length of 8 mm and pixels of 4.8 µm, and the distortion k1, k2, p1, p2.
TEST(Distortion, IsThatOfOpenCv) {
  struct Case {
    Distortion lens;
    Vec2 first_px, second_px;
  };
  const Case cases[] = {
      {{-0.21, 0.08, 1.3e-3, -7e-4},
       {215.78716752188862, -557.5657606112438},
       {-75.28787387225167, 301.06368557165126}},
      {{0.0, 0.0, 2e-3, 0.0},
       {221.91604938271604, -572.8283950617284},
       {-75.81267217630855, 303.36776859504135}},
      {{0.3, -0.1, 0.0, 1e-3},
       {231.18993463056103, -596.6533016364939},
       {-76.48107457679039, 306.15845808677585}},
  };
  const double focal_px = 8e-3 / 4.8e-6;
  for (const Case& c : cases) {
    const Vec2 first = focal_px * c.lens.distorted(Vec2(0.12, -0.31) / 0.9),
               second = focal_px * c.lens.distorted(Vec2(-0.05, 0.2) / 1.1);
    EXPECT_LT((first - c.first_px).norm(), 1e-9);
    EXPECT_LT((second - c.second_px).norm(), 1e-9);
  }
}

// Derivatives of the image by the pose, compared with differences.
void expect_derivatives(const TrackingCamera& camera, const Pose& pose, double step,
                        double tolerance) {
  for (size_t marker = 0; marker < camera.markers.size(); ++marker) {
    const auto view = view_of(camera, marker, pose);
    ASSERT_TRUE(view);
    for (int k = 0; k < 6; ++k) {
      const auto moved = [&](double by) {
        Pose other = pose;
        if (k < 3) {
          other.lab_from_body = turn_by(by * Vec3::Unit(k)) * pose.lab_from_body;
        } else {
          other.centre_m[k - 3] += by;
        }
        return view_of(camera, marker, other)->pixel;
      };
      const Vec2 expected = (moved(step) - moved(-step)) / (2.0 * step);
      EXPECT_LT((view->derivative.col(k) - expected).norm(), tolerance * (1.0 + expected.norm()))
          << marker << k;
    }
  }
}

TEST(Distortion, IsInTheDerivativesOfTheImage) {
  TrackingCamera camera = cross_camera();
  camera.distortion = {-0.3, 0.1, 2e-3, -1e-3};
  expect_derivatives(camera, leaning_by(20.0, 30.0), 1e-5, 1e-6);
}

// A calibrated lens does not rotate the pose, however much it distorts. An uncalibrated lens
// enlarges or reduces images of a cross on its axis and does not rotate the pose either, by
// symmetry. Off the axis it shifts images by k₁ r³ f, here along the direction of the tilt. The
// apparent tilt is the mean of this shift, weighted by height, divided by the mean height.
TEST(Distortion, TurnsThePoseWhereItIsNotCalibrated) {
  TrackingCamera camera = cross_camera();
  camera.distortion = {-0.3, 0.1, 2e-3, -1e-3};
  const Pose lean = leaning_by(15.0, 0.0);
  EXPECT_LT(marker_bias_lab_rad(camera, lean)->norm(), 1e-9);
  camera.distortion_error = {-0.1, 0.0, 0.0, 0.0};
  camera.distortion = {};
  EXPECT_LT(marker_bias_lab_rad(camera, leaning_by(0.0, 0.0))->norm(), 1e-7);
  camera.weighs_alike = true;
  const Vec3 found = *marker_bias_lab_rad(camera, lean);
  // By symmetry, least squares for a rotation about lab y alone: a rotation δ moves the image of
  // (x, y, z) by f ∂u/∂δ, u = (x, y)/(1 − z).
  double normal = 0.0, right = 0.0;
  for (const Marker& m : camera.markers) {
    const Vec3 p = lean.lab_from_body * m.position_body_m;
    const double depth = 1.0 - p.z();
    const Vec2 u = p.head<2>() / depth;
    // dp = δ (z, 0, −x)
    const Vec2 by_turn(p.z() / depth - u.x() * p.x() / depth, -u.y() * p.x() / depth);
    normal += by_turn.squaredNorm();
    right += by_turn.dot(-0.1 * u.squaredNorm() * u);
  }
  EXPECT_NEAR(found.y(), right / normal, 0.02 * std::abs(found.y()));
  EXPECT_LT(Vec2(found.x(), found.z()).norm(), 0.02 * std::abs(found.y()));
  EXPECT_GT(std::abs(found.y()), 10.0 * arcsecond_rad);
}

// Equal weights lose little accuracy if all spots are about as bright, and simulated images agree
// with the covariance that is predicted for equal weights.
TEST(Distortion, AndEqualWeightsAgreeWithTheirImages) {
  TrackingCamera camera = cross_camera();
  camera.distortion = {-0.3, 0.1, 2e-3, -1e-3};
  camera.markers[2].normal_body = Vec3(0.0, 0.9, 0.45).normalized();  // dimmer
  const Pose pose = leaning_by(10.0, 40.0);
  const Mat3 best = *attitude_covariance_lab_rad2(camera, pose);
  camera.weighs_alike = true;
  const Mat3 alike = *attitude_covariance_lab_rad2(camera, pose);
  EXPECT_GT(alike.trace(), 1.01 * best.trace());
  constexpr int images = 1000;
  const ImageStatistics seen = take_images(camera, pose, images, 3, alike);
  EXPECT_EQ(seen.failed, 0);
  EXPECT_NEAR(seen.chi2, 1.0, 4.0 * std::sqrt(2.0 / (3.0 * images)));
}

// Far away the image is a parallel projection. A rotation about the optical axis moves a marker by
// its distance r from the axis; a rotation across it moves a marker by its height z. With equal
// errors s of all images, the errors of the attitude are s/√Σr² and s/√Σz².
TEST(AttitudeCovariance, OfADistantBoardHasItsClosedForm) {
  TrackingCamera camera = cross_camera();
  camera.focal_length_m = 4.0;
  camera.radiant_intensity_W_sr = 1e-3;
  camera.f_number = 4.0;
  const double distance_m = 400.0;
  camera.lab_from_camera = frame_looking_along({0, 0, -1}, {0, 0, distance_m});
  const auto view = view_of(camera, 0, {});
  ASSERT_TRUE(view);
  const Mat2 centre = centre_covariance_px2(spot_of(camera, *view), pixel_noise(camera));
  const double s_m = std::sqrt(centre(0, 0)) * camera.pixel_m * distance_m / camera.focal_length_m;
  const auto covariance = attitude_covariance_lab_rad2(camera, {});
  ASSERT_TRUE(covariance);
  const PlaneErrors errors = plane_errors(camera, *covariance);
  EXPECT_NEAR(errors.in_plane_rad / (s_m / (2.0 * 0.08075)), 1.0, 3e-3);
  EXPECT_NEAR(errors.out_of_plane_rad / (s_m / (std::sqrt(5.0) * 0.0255)), 1.0, 3e-3);
}

TEST(AttitudeCovariance, OfTheStatedBoardAndLensIsThePapers) {
  const TrackingCamera camera = cross_camera();
  const PlaneErrors errors = plane_errors(camera, *attitude_covariance_lab_rad2(camera, {}));
  EXPECT_NEAR(errors.in_plane_rad / arcsecond_rad, 12.0, 1.0);
  EXPECT_NEAR(errors.out_of_plane_rad / arcsecond_rad, 37.0, 2.0);
}

// Equal errors s of all images along both axes: J⁺ J⁺ᵀ s², the formula for noise of this size.
TEST(AttitudeCovariance, GrowsWithTheErrorOfCalibrationInProportion) {
  const TrackingCamera camera = cross_camera();
  const Pose pose = leaning_by(12, 40);
  const Mat3 one = *calibration_error_lab_rad2(camera, pose, 0.1);
  const Mat3 two = *calibration_error_lab_rad2(camera, pose, 0.2);
  EXPECT_LT((two - 4.0 * one).norm(), 1e-12 * two.norm());
  // With a known centre, a shift of all images by 0.1 px looks like a tilt.
  const Mat3 shifted = *principal_point_error_lab_rad2(camera, {}, 0.1);
  EXPECT_GT(plane_errors(camera, shifted).out_of_plane_rad,
            2.0 * plane_errors(camera, one).out_of_plane_rad);
}

TEST(ViewOfAMarker, HasExactDerivatives) {
  expect_derivatives(cross_camera(), leaning_by(17, 130), 1e-6, 1e-5);
}

TEST(ViewOfAMarker, IsGoneWhereNoLightComes) {
  TrackingCamera camera = cross_camera();
  EXPECT_TRUE(view_of(camera, 1, {}));
  camera.markers[1].is_lit = false;
  EXPECT_FALSE(view_of(camera, 1, {}));
  EXPECT_FALSE(view_of(camera, 2, leaning_by(120, 0)));  // turned away
  camera.is_hidden = [](size_t marker, const Quat&) { return marker == 3; };
  EXPECT_FALSE(view_of(camera, 3, {}));
  camera.width = 200;  // outside of the sensor
  camera.is_hidden = nullptr;
  EXPECT_FALSE(view_of(camera, 3, {}));
}

// A spot of less than one electron or with a very long trace is no reading. The errors of such
// spots have no bound, and an estimate would follow them.
TEST(ViewOfAMarker, IsGoneWhereTheSpotIsTooFaintOrTooLong) {
  TrackingCamera camera = cross_camera();
  const double electrons = view_of(camera, 1, {})->electrons, dimmed = 0.9 / electrons;
  camera.radiant_intensity_W_sr *= 2.0 * dimmed;
  EXPECT_TRUE(view_of(camera, 1, {}));
  camera.radiant_intensity_W_sr *= 0.5;
  EXPECT_FALSE(view_of(camera, 1, {}));
  camera = cross_camera();
  camera.markers[0].normal_body = Vec3(1.0, 0.0, 1e-18).normalized();  // edge-on
  EXPECT_FALSE(view_of(camera, 0, {}));
  // A marker 80.75 mm from the axis and 0.9745 m from a lens of 8 mm, with pixels of 4.8 µm, moves
  // by 0.0062 px in 45 µs at 1 rad/s: by 62 px at 1e4 rad/s and by 186 px at 3e4 rad/s.
  camera = cross_camera();
  Pose spinning;
  spinning.rate_lab_rad_s = {0, 0, 1e4};
  ASSERT_TRUE(view_of(camera, 1, spinning));
  EXPECT_NEAR(view_of(camera, 1, spinning)->smear_px.norm(),
              1e4 * 45e-6 * 0.08075 / 0.9745 * 8e-3 / 4.8e-6, 1e-6);
  spinning.rate_lab_rad_s *= 3.0;
  EXPECT_FALSE(view_of(camera, 1, spinning));
}

std::vector<MarkerReading> exact_readings(const TrackingCamera& camera, const Pose& pose) {
  std::vector<MarkerReading> readings;
  for (size_t i = 0; i < camera.markers.size(); ++i) {
    readings.push_back({i, view_of(camera, i, pose)->pixel, 1e-4 * Mat2::Identity()});
  }
  return readings;
}

// Without noise the pose is exact from an initial value that is wrong by degrees, with a known and
// with a free centre.
TEST(PoseOfMarkers, IsExactWithoutNoise) {
  for (const bool knows_centre : {true, false}) {
    TrackingCamera camera = cross_camera();
    camera.knows_centre = knows_centre;
    Pose truth = leaning_by(14, 70);
    if (!knows_centre) truth.centre_m = {1e-3, -2e-3, 3e-3};
    const auto found = find_pose(camera, exact_readings(camera, truth), leaning_by(11, 65));
    ASSERT_TRUE(found);
    EXPECT_LT(found->pose.lab_from_body.angularDistance(truth.lab_from_body), 1e-9);
    EXPECT_LT((found->pose.centre_m - truth.centre_m).norm(), 1e-9);
    EXPECT_EQ(found->readings, 10);
  }
}

// A board that is rotated on its plate relative to the drawing rotates every attitude by this
// angle.
TEST(PoseOfMarkers, TakesOverATurnedBoard) {
  TrackingCamera camera = cross_camera();
  const Vec3 turn_rad(2e-4, -1e-4, 5e-4);
  for (const Marker& marker : camera.markers) {
    camera.marker_error_body_m.emplace_back(turn_by(turn_rad) * marker.position_body_m -
                                            marker.position_body_m);
  }
  const Pose pose = leaning_by(9, -30);
  const auto bias = marker_bias_lab_rad(camera, pose);
  ASSERT_TRUE(bias);
  EXPECT_LT((*bias - pose.lab_from_body * turn_rad).norm(), 1e-9);
}

// Rows that are exposed one after the other: the pose is exact if the rate is known. Otherwise its
// error is the rate times the time between the rows of the board's image.
TEST(PoseOfMarkers, IncludesTheDelayOfARollingShutter) {
  TrackingCamera camera = cross_camera();
  camera.line_time_s = 1e-5;
  Pose truth = leaning_by(5, 20);
  truth.rate_lab_rad_s = {0.05, 0.02, 0.5};
  const std::vector<MarkerReading> readings = exact_readings(camera, truth);
  const auto knowing = find_pose(camera, readings, truth);
  Pose at_rest = truth;
  at_rest.rate_lab_rad_s.setZero();
  const auto not_knowing = find_pose(camera, readings, at_rest);
  ASSERT_TRUE(knowing && not_knowing);
  EXPECT_LT(knowing->pose.lab_from_body.angularDistance(truth.lab_from_body), 1e-8);
  EXPECT_GT(not_knowing->pose.lab_from_body.angularDistance(truth.lab_from_body), 1e-5);
}

// Simulated images compared with the predicted covariance: χ² of 12 numbers per image of each of
// four attitudes.
double chi2_of_images(const TrackingCamera& camera, const TrackingCamera& predicting, int images) {
  double sum = 0.0;
  const std::pair<double, double> attitudes[] = {{0, 0}, {10, 30}, {20, 200}, {30, 90}};
  uint64_t seed = 7;
  for (const auto& [tilt, heading] : attitudes) {
    const Pose pose = leaning_by(tilt, heading);
    const Mat3 predicted = *attitude_covariance_lab_rad2(predicting, pose);
    const ImageStatistics seen = take_images(camera, pose, images, ++seed, predicted);
    EXPECT_EQ(seen.failed, 0);
    EXPECT_NEAR(seen.chi2_fit, 1.0, 4.0 * std::sqrt(2.0 / (7.0 * images)));
    sum += 0.25 * seen.chi2;
  }
  return sum;
}

TEST(SimulatedImages, ErrAsPredicted) {
  const TrackingCamera camera = cross_camera();
  EXPECT_NEAR(chi2_of_images(camera, camera, 600), 1.0, 4.0 * std::sqrt(2.0 / (12.0 * 600)));
}

// A deliberately wrong prediction, without the read noise.
TEST(SimulatedImages, DoNotErrAsPredictedWithoutReadNoise) {
  const TrackingCamera camera = cross_camera();
  TrackingCamera predicting = camera;
  predicting.read_noise_electrons = 1.0;
  EXPECT_GT(chi2_of_images(camera, predicting, 200), 1.1);
}

TEST(SimulatedImages, AreReadFasterThanTheCameraTakesThem) {
  const TrackingCamera camera = cross_camera();
  const auto start = std::chrono::steady_clock::now();
  for (uint64_t i = 0; i < 320; ++i) ASSERT_TRUE(take_image(camera, {}, {}, 1, i));
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  EXPECT_GT(320.0 / wall.count(), 160.0);
}

// Recorded attitudes scatter as the geometry predicts, at a tilt where the errors of x, y and z
// differ from those at zero tilt.
TEST(CameraWithGeometry, MakesTheNoiseOfARecording) {
  Sensors sensors;
  sensors.camera.emplace().geometry = cross_camera();
  Recorder recorder(sensors, 5);
  const Pose pose = leaning_by(25, 60);
  constexpr int rows = 2000;
  for (int i = 0; i < rows; ++i) {
    Truth truth;
    truth.time_s = 0.1 * i;
    truth.lab_from_body_seen = pose.lab_from_body;
    recorder.add(truth);
  }
  const Recording recording = recorder.finish();
  const Mat3 weight = attitude_covariance_lab_rad2(*sensors.camera->geometry, pose)->inverse();
  double chi2 = 0.0;
  for (size_t i = 0; i < rows; ++i) {
    const auto cell = [&](const char* name) { return recording.find(name)->values[i]; };
    const Quat seen(cell("q_w"), cell("q_x"), cell("q_y"), cell("q_z"));
    const Vec3 error_rad = turn_vector(seen * pose.lab_from_body.conjugate());
    chi2 += error_rad.dot(weight * error_rad) / (3.0 * rows);
  }
  EXPECT_NEAR(chi2, 1.0, 4.0 * std::sqrt(2.0 / (3.0 * rows)));
}

TEST(CameraSettings, RejectImpossibleValues) {
  const auto camera = [](const std::string& change) {
    SettingsNode keys = keys_node(
        "markers_m = [[0, 0, 0.03], [0.1, 0, 0.03], [0, 0.1, 0.03], [-0.1, 0, 0.03]], "
        "intensity_W_sr = 1.7e-5, focal_length_mm = 8, pixel_um = 4.8, resolution = [1280, "
        "1024], exposure_s = 45e-6, position_m = [0, 0, 1]");
    apply_override(keys, change);
    return read_tracking_camera(Settings(keys));
  };
  EXPECT_TRUE(camera("exposure_s=45e-6"));
  EXPECT_THROW(camera("exposure_s=1.0"), InputError);   // saturated
  EXPECT_THROW(camera("aim_m=[0, 0, 2]"), InputError);  // looks away
  EXPECT_THROW(camera("resolution=[100]"), InputError);
  EXPECT_THROW(camera("marker_error_m=[[0, 0, 0]]"), InputError);
}

}  // namespace
}  // namespace photorque
