#include "raytrace/tracing/ray_placement.h"

#include <algorithm>

namespace photorque {

RayPlacement::RayPlacement(const RigidTransform& body_from_emitter,
                           const TraceableScene::Data& scene) {
  const double centre_z_m = body_from_emitter.inverse().point(scene.centre_m).z();
  const double start_z_m = std::max(0.0, centre_z_m - 1.001 * scene.radius_m);
  starts_late_ = start_z_m > 0.0;
  start_z_m_ = static_cast<float>(start_z_m);
  landing_z_m_ = static_cast<float>(centre_z_m);
  const Mat3 rotation = body_from_emitter.rotation.toRotationMatrix();
  const Vec3 offset_m = body_from_emitter.point(Vec3(0.0, 0.0, start_z_m));
  for (size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (size_t k = 0; k < 3; ++k) {
      rotation_[i][k] = static_cast<float>(rotation(row, static_cast<Eigen::Index>(k)));
    }
    offset_m_[i] = static_cast<float>(offset_m[row]);
  }
}

// What is written lies apart from what is read, which the compiler must know to vectorise.
void RayPlacement::place(const RayBlock& __restrict rays, RayColumns& __restrict placed,
                         Landing& __restrict landing) const {
  constexpr float min_z = 1e-6f;  // of the directions of rays that may reach the plane
  const float start_m = start_z_m_, landing_m = landing_z_m_;
  const float late = starts_late_ ? 1.0f : 0.0f;
  const float ahead = landing_m > 0.0f ? 1.0f : 0.0f;
  const auto r = rotation_;
  const auto offset_m = offset_m_;
  for (int i = 0; i < ray_block; ++i) {
    const float fx = rays.direction[0][i], fy = rays.direction[1][i], fz = rays.direction[2][i];
    const float ex = rays.origin_m[0][i], ey = rays.origin_m[1][i], ez = rays.origin_m[2][i];
    const float per_z = 1.0f / (fz > min_z ? fz : min_z);
    const float gap_m = late * (start_m > ez ? start_m - ez : 0.0f);
    const float step = gap_m * per_z;
    const float sx = ex + step * fx, sy = ey + step * fy;
    // Rays that get there are on the plane without rounding.
    const float on_plane = (fz > min_z ? 1.0f : 0.0f) * (gap_m > 0.0f ? 1.0f : 0.0f);
    const float sz = (1.0f - on_plane) * (step * fz + (ez - start_m));
    for (size_t k = 0; k < 3; ++k) {
      placed[k][i] = r[k][0] * sx + r[k][1] * sy + r[k][2] * sz + offset_m[k];
      placed[3 + k][i] = r[k][0] * fx + r[k][1] * fy + r[k][2] * fz;
    }
    const float reach = ahead * (landing_m - ez) * per_z + (1.0f - ahead);
    landing.x[i] = ahead * ex + reach * fx;
    landing.y[i] = ahead * ey + reach * fy;
  }
}

}  // namespace photorque
