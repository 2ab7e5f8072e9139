#include "tools/pages/platform.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "scenes/experiment/experiment.h"

namespace photorque {
namespace {

// Half axes in body axes: columns are their directions times their lengths, the longest 0.5 m.
Mat3 half_axes_m(const Platform& platform) {
  if (platform.turns_about_one_axis()) {
    return 0.5 * (Mat3::Identity() - 0.9 * platform.axis * platform.axis.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(platform.inertia_kg_m2);
  const Vec3& moments = solver.eigenvalues();
  // Of an even ellipsoid of mass m: I1 = m (b² + c²) / 5 and so on, so a² ∝ I2 + I3 − I1.
  Vec3 lengths;
  for (int k = 0; k < 3; ++k) {
    lengths[k] = std::sqrt(std::max(0.0, 0.5 * moments.sum() - moments[k]));
  }
  const double longest = lengths.maxCoeff();
  // A body without extent along an axis is drawn as a thin one.
  lengths = lengths.cwiseMax(0.04 * longest) * (0.5 / longest);
  return solver.eigenvectors() * lengths.asDiagonal();
}

StagePart ellipsoid(const Mat3& axes_m) {
  constexpr int around = 36, along = 18;
  StagePart part{"platform", {0.72, 0.74, 0.77}, {}, {}};
  for (int i = 0; i <= along; ++i) {
    for (int j = 0; j < around; ++j) {
      const double polar = pi * i / along, turn = 2.0 * pi * j / around;
      const Vec3 at = axes_m * Vec3(std::sin(polar) * std::cos(turn),
                                    std::sin(polar) * std::sin(turn), std::cos(polar));
      for (int k = 0; k < 3; ++k) part.position_m.push_back(static_cast<float>(at[k]));
    }
  }
  const auto vertex = [](int i, int j) { return static_cast<uint32_t>(i * around + j % around); };
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) {
      part.triangles.insert(part.triangles.end(),
                            {vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      part.triangles.insert(part.triangles.end(),
                            {vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j + 1)});
    }
  }
  return part;
}

// A square rod from the origin.
StagePart rod_along_x(double length_m) {
  const auto l = static_cast<float>(length_m);
  const auto w = static_cast<float>(0.02);
  StagePart rod{"body x", {0.30, 0.33, 0.37}, {}, {}};
  for (const float x : {0.0f, l}) {
    for (const float y : {-w, w}) {
      for (const float z : {-w, w}) rod.position_m.insert(rod.position_m.end(), {x, y, z});
    }
  }
  rod.triangles = {0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7, 0, 4, 1, 1, 4, 5,
                   2, 3, 6, 3, 7, 6, 0, 2, 4, 2, 6, 4, 1, 5, 3, 3, 5, 7};
  return rod;
}

}  // namespace

SceneStage platform_stage(const Platform& platform) {
  SceneStage stage;
  const Mat3 axes_m = half_axes_m(platform);
  // Of the ellipsoid along x: the largest x of a point on it.
  stage.parts = {ellipsoid(axes_m), rod_along_x(axes_m.row(0).norm() + 0.15)};
  stage.radius_m = 0.6;
  const Camera camera = camera_framing(stage.radius_m);
  stage.camera = {camera.position_m, camera.target_m, camera.field_of_view_rad / degree_rad};
  stage.remark = platform.turns_about_one_axis()
                     ? "The experiment names no scene: a disc about its axis stands for the "
                       "platform; the rod is along body x."
                     : "The experiment names no scene: an ellipsoid with the proportions of the "
                       "platform's moments of inertia stands for it; the rod is along body x.";
  return stage;
}

}  // namespace photorque
