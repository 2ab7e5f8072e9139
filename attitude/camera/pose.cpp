#include "attitude/camera/pose.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>

#include "core/transform.h"

namespace photorque {
namespace {

// The readings against a pose that differs from the first by a rotation vector (lab axes) and, with
// six unknowns, by a shift in the lab. Residuals are divided by their standard deviations.
template <int unknowns>
struct PoseResiduals {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = unknowns };

  const TrackingCamera& camera;
  const std::vector<MarkerReading>& readings;
  const Pose& first;
  std::vector<Mat2> whitener;

  int NumResiduals() const { return 2 * static_cast<int>(readings.size()); }

  Pose pose(const double* x) const {
    Pose pose = first;
    pose.lab_from_body = (turn_by({x[0], x[1], x[2]}) * first.lab_from_body).normalized();
    if constexpr (unknowns == 6) pose.centre_m += Vec3(x[3], x[4], x[5]);
    return pose;
  }

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    const Pose now = pose(x);
    Eigen::Matrix<double, 6, 6> by_unknowns = Eigen::Matrix<double, 6, 6>::Identity();
    by_unknowns.topLeftCorner<3, 3>() = turn_jacobian({x[0], x[1], x[2]});
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, unknowns>> rows(jacobian, NumResiduals(),
                                                                     unknowns);
    for (size_t i = 0; i < readings.size(); ++i) {
      const auto view = view_of(camera, readings[i].marker, now);
      const auto at = static_cast<Eigen::Index>(2 * i);
      // What the pose takes to be out of sight pulls nowhere.
      Vec2 residual = Vec2::Constant(1e3);
      if (view) residual = whitener[i] * (view->pixel - readings[i].pixel);
      residuals[at] = residual.x();
      residuals[at + 1] = residual.y();
      if (jacobian == nullptr) continue;
      rows.template middleRows<2>(at).setZero();
      if (!view) continue;
      rows.template middleRows<2>(at) =
          (whitener[i] * view->derivative * by_unknowns).template leftCols<unknowns>();
    }
    return true;
  }
};

template <int unknowns>
std::optional<FoundPose> least_chi2_pose(const TrackingCamera& camera,
                                         const std::vector<MarkerReading>& readings,
                                         const Pose& first) {
  PoseResiduals<unknowns> residuals{camera, readings, first, {}};
  Mat2 mean_px2 = Mat2::Zero();
  for (const MarkerReading& reading : readings) {
    mean_px2 += 0.5 * reading.covariance_px2.trace() * Mat2::Identity() /
                static_cast<double>(readings.size());
  }
  for (const MarkerReading& reading : readings) {
    const Eigen::LLT<Mat2> factor(camera.weighs_alike ? mean_px2 : reading.covariance_px2);
    residuals.whitener.push_back(factor.matrixL().solve(Mat2::Identity()));
  }
  using Solver = ceres::TinySolver<PoseResiduals<unknowns>>;
  Solver solver;
  solver.options.max_num_iterations = 50;
  solver.options.function_tolerance = 1e-9;  // of chi², an absolute number here
  typename Solver::Parameters x = Solver::Parameters::Zero();
  solver.Solve(residuals, &x);
  if (solver.summary.status == Solver::HIT_MAX_ITERATIONS || !x.allFinite()) return {};
  return FoundPose{residuals.pose(x.data()), 2.0 * solver.summary.final_cost,
                   residuals.NumResiduals(), unknowns};
}

}  // namespace

std::optional<FoundPose> find_pose(const TrackingCamera& camera,
                                   const std::vector<MarkerReading>& readings, const Pose& first) {
  if (camera.knows_centre) {
    if (readings.size() < 2) return {};
    return least_chi2_pose<3>(camera, readings, first);
  }
  if (readings.size() < 4) return {};
  return least_chi2_pose<6>(camera, readings, first);
}

}  // namespace photorque
