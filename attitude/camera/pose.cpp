#include "attitude/camera/pose.h"

#include <Eigen/LU>
#include <cmath>

#include "core/numerics/linear.h"
#include "core/transform.h"
#include "inference/estimator/fit.h"

namespace photorque {

namespace {

// Residuals of the readings for a pose that differs from `first` by a rotation vector (lab axes)
// and, with six unknowns, by a shift in the lab. They are divided by their standard deviations.
struct PoseResiduals {
  const TrackingCamera& camera;
  const std::vector<MarkerReading>& readings;
  const Pose& first;
  std::vector<Mat2> whitener;

  Pose pose(const Eigen::VectorXd& x) const {
    Pose pose = first;
    pose.lab_from_body = (turn_by({x[0], x[1], x[2]}) * first.lab_from_body).normalized();
    if (x.size() == 6) pose.centre_m += Vec3(x[3], x[4], x[5]);
    return pose;
  }

  void operator()(const Eigen::VectorXd& x, Eigen::VectorXd& residuals,
                  Eigen::MatrixXd* slopes) const {
    const Pose now = pose(x);
    Eigen::Matrix<double, 6, 6> by_unknowns = Eigen::Matrix<double, 6, 6>::Identity();
    by_unknowns.topLeftCorner<3, 3>() = turn_jacobian({x[0], x[1], x[2]});
    const auto rows = static_cast<Eigen::Index>(2 * readings.size());
    // A marker that is not visible in the pose has a constant large residual and no derivative.
    residuals.setConstant(rows, 1e3);
    if (slopes != nullptr) slopes->setZero(rows, x.size());
    for (size_t i = 0; i < readings.size(); ++i) {
      const auto view = view_of(camera, readings[i].marker, now);
      if (!view) continue;
      const auto at = static_cast<Eigen::Index>(2 * i);
      residuals.segment<2>(at) = whitener[i] * (readings[i].pixel - view->pixel);
      if (slopes == nullptr) continue;
      const Eigen::Matrix<double, 2, 6> slope = whitener[i] * view->derivative * by_unknowns;
      slopes->middleRows<2>(at) = slope.leftCols(x.size());
    }
  }
};

std::optional<FoundPose> least_chi2_pose(const TrackingCamera& camera,
                                         const std::vector<MarkerReading>& readings,
                                         const Pose& first, int unknowns) {
  PoseResiduals residuals{camera, readings, first, {}};
  Mat2 mean_px2 = Mat2::Zero();
  for (const MarkerReading& reading : readings) {
    mean_px2 += 0.5 * reading.covariance_px2.trace() * Mat2::Identity() /
                static_cast<double>(readings.size());
  }
  for (const MarkerReading& reading : readings) {
    const Eigen::LLT<Mat2> factor(camera.weighs_alike ? mean_px2 : reading.covariance_px2);
    residuals.whitener.push_back(factor.matrixL().solve(Mat2::Identity()));
  }
  const std::vector<inference::Parameter> parameters(static_cast<size_t>(unknowns));
  const inference::ResidualModel model(
      parameters, [&residuals](const Eigen::VectorXd& values, Eigen::Index, Eigen::VectorXd& r,
                               Eigen::MatrixXd* slopes) { residuals(values, r, slopes); });
  inference::Options options;
  options.max_iterations = 50;
  options.min_gain = 1e-9;
  options.min_gain_fraction = 1e-12;
  const inference::Fit fit = inference::fit(model, model.start(), options);
  if (fit.termination == inference::Termination::max_iterations || !fit.at.allFinite()) return {};
  return FoundPose{residuals.pose(fit.at), fit.chi2, static_cast<int>(2 * readings.size()),
                   unknowns};
}

}  // namespace

std::optional<FoundPose> find_pose(const TrackingCamera& camera,
                                   const std::vector<MarkerReading>& readings, const Pose& first) {
  if (camera.knows_centre) {
    if (readings.size() < 2) return {};
    return least_chi2_pose(camera, readings, first, 3);
  }
  if (readings.size() < 4) return {};
  return least_chi2_pose(camera, readings, first, 6);
}

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;

// Derivatives of the attitude with respect to the image of each marker [rad/pixel], and its
// covariance.
struct Answer {
  std::vector<Eigen::Matrix<double, 3, 2>> by_reading;
  Mat3 covariance_rad2;
};

std::optional<Answer> answer_of(const TrackingCamera& camera, const Pose& pose) {
  std::vector<Eigen::Matrix<double, 6, 2>> weighted;
  std::vector<Mat2> noise;
  Mat6 information = Mat6::Zero();
  for (size_t i = 0; i < camera.markers.size(); ++i) {
    const auto view = view_of(camera, i, pose);
    if (!view) continue;
    noise.push_back(centre_covariance_px2(spot_of(camera, *view), pixel_noise(camera)));
    const Mat2 weight = camera.weighs_alike ? Mat2(Mat2::Identity()) : Mat2(noise.back().inverse());
    weighted.emplace_back(view->derivative.transpose() * weight);
    information += weighted.back() * view->derivative;
  }
  const int unknowns = camera.knows_centre ? 3 : 6;
  // In units in which rotations and shifts have equal weight, so that unobserved directions are
  // detected.
  const Eigen::MatrixXd own = information.topLeftCorner(unknowns, unknowns);
  const Eigen::VectorXd scale = own.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return {};
  const Eigen::MatrixXd even =
      scale.cwiseInverse().asDiagonal() * own * scale.cwiseInverse().asDiagonal();
  constexpr double singular = 1e-10;
  if (!(symmetric_eigen(even).values[0] >= singular)) return {};
  const Eigen::MatrixXd covariance =
      scale.cwiseInverse().asDiagonal() * even.inverse() * scale.cwiseInverse().asDiagonal();
  Answer answer;
  answer.covariance_rad2 = covariance.topLeftCorner<3, 3>();
  for (const auto& one : weighted) {
    answer.by_reading.emplace_back((covariance * one.topRows(unknowns)).topRows<3>());
  }
  if (camera.weighs_alike) {
    answer.covariance_rad2.setZero();
    for (size_t i = 0; i < noise.size(); ++i) {
      const Eigen::Matrix<double, 3, 2>& by = answer.by_reading[i];
      answer.covariance_rad2 += by * noise[i] * by.transpose();
    }
  }
  return answer;
}

}  // namespace

std::optional<Mat3> attitude_covariance_lab_rad2(const TrackingCamera& camera, const Pose& pose) {
  const auto answer = answer_of(camera, pose);
  if (!answer) return {};
  return answer->covariance_rad2;
}

std::optional<Mat3> calibration_error_lab_rad2(const TrackingCamera& camera, const Pose& pose,
                                               double error_px) {
  const auto answer = answer_of(camera, pose);
  if (!answer) return {};
  Mat3 sum = Mat3::Zero();
  for (const auto& one : answer->by_reading) sum += one * one.transpose();
  return error_px * error_px * sum;
}

std::optional<Mat3> principal_point_error_lab_rad2(const TrackingCamera& camera, const Pose& pose,
                                                   double error_px) {
  const auto answer = answer_of(camera, pose);
  if (!answer) return {};
  Eigen::Matrix<double, 3, 2> sum = Eigen::Matrix<double, 3, 2>::Zero();
  for (const auto& one : answer->by_reading) sum += one;
  return error_px * error_px * sum * sum.transpose();
}

PlaneErrors plane_errors(const TrackingCamera& camera, const Mat3& covariance_lab_rad2) {
  const Mat3 axes = camera.lab_from_camera.rotation.toRotationMatrix();
  const Mat3 seen = axes.transpose() * covariance_lab_rad2 * axes;
  return {std::sqrt(seen(2, 2)), std::sqrt(0.5 * (seen(0, 0) + seen(1, 1)))};
}

std::optional<Vec3> marker_bias_lab_rad(const TrackingCamera& camera, const Pose& pose) {
  std::vector<MarkerReading> readings;
  for (size_t i = 0; i < camera.markers.size(); ++i) {
    const auto view = view_of(camera, i, pose, true);
    if (!view) continue;
    readings.push_back(
        {i, view->pixel, centre_covariance_px2(spot_of(camera, *view), pixel_noise(camera))});
  }
  const auto found = find_pose(camera, readings, pose);
  if (!found) return {};
  return turn_vector(found->pose.lab_from_body * pose.lab_from_body.conjugate());
}

std::optional<ImageResult> take_image(const TrackingCamera& camera, const Pose& truth,
                                      const Pose& first, uint64_t seed, uint64_t image) {
  const PixelNoise noise = pixel_noise(camera);
  const Vec2 middle_px = 0.5 * Vec2(camera.width - 1.0, camera.height - 1.0);
  std::vector<MarkerReading> readings;
  for (size_t i = 0; i < camera.markers.size(); ++i) {
    const auto view = view_of(camera, i, truth, true);
    const auto expected = view_of(camera, i, first);
    if (!view || !expected) continue;
    const PixelWindow window = expose(spot_of(camera, *view), noise, seed, image, i);
    const auto spot = read_spot(window, spot_of(camera, *expected), noise);
    if (!spot) continue;
    readings.push_back({i, spot->centre_px - middle_px, centre_covariance_px2(*spot, noise)});
  }
  auto found = find_pose(camera, readings, first);
  if (!found) return {};
  const Vec3 error_rad = turn_vector(found->pose.lab_from_body * truth.lab_from_body.conjugate());
  return ImageResult{*found, error_rad};
}

ImageStatistics take_images(const TrackingCamera& camera, const Pose& truth, int images,
                            uint64_t seed, const Mat3& predicted_lab_rad2) {
  const Mat3 weight = predicted_lab_rad2.inverse();
  ImageStatistics sum;
  double fit_chi2 = 0.0, fit_freedom = 0.0;
  for (int i = 0; i < images; ++i) {
    ++sum.images;
    const auto image = take_image(camera, truth, truth, seed, static_cast<uint64_t>(i));
    if (!image) {
      ++sum.failed;
      continue;
    }
    const Vec3& error_rad = image->error_lab_rad;
    sum.chi2 += error_rad.dot(weight * error_rad) / 3.0;
    sum.covariance += error_rad * error_rad.transpose();
    sum.mean_rad += error_rad;
    fit_chi2 += image->found.chi2;
    fit_freedom += image->found.readings - image->found.unknowns;
  }
  const double count = std::max(1, sum.images - sum.failed);
  sum.chi2 /= count;
  sum.covariance /= count;
  sum.mean_rad /= count;
  sum.chi2_fit = fit_freedom > 0.0 ? fit_chi2 / fit_freedom : 0.0;
  return sum;
}

}  // namespace photorque
