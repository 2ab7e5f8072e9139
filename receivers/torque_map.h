// Torque of light on part of a scene, per bin.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "raytrace/receiver.h"
#include "receivers/hit_binner.h"
#include "receivers/surface_grid.h"

namespace photorque {

// Torque about `about_body_m` in the body frame, x, y, z.
struct TorqueMap {
  SurfaceGrid grid;
  Vec3 about_body_m = Vec3::Zero();
  std::array<std::vector<Estimate>, 3> per_bin_N_m;  // NaN in bins without surface
  std::array<Estimate, 3> total_N_m;                 // errors from the replicates of the total
};

// `kind = "torque_map"`. Bins: for every bin of the grid, the torque about `about_body_m`, x, y, z
// in the body frame [N m]. The values are per bin, not per area: their sum is the torque. The first
// half is light directly from the emitters, the second half, in the same order, light that has met
// a surface before.
class TorqueMapReceiver final : public Receiver {
 public:
  // Force of light on an element.
  // - `momentum`: momentum in minus momentum out.
  // - `as_published`: equation 29 of the paper for each ray, power/c |d·n| d with the ray's
  // direction of travel d. It applies the cosine, which the power on a surface already contains, a
  // second time; it assumes complete absorption and ignores earlier bounces. Not available with
  // gathering.
  enum class Force { momentum, as_published };

  // `grid` must have been made for `scene`.
  TorqueMapReceiver(std::string name, const Scene& scene, SurfaceGrid grid,
                    const Vec3& about_body_m = Vec3::Zero(), Force force = Force::momentum);

  size_t bins() const override;
  void score(const Hits& hits, std::span<double> sums) const override;
  // Number of bins of direct light; they are the first half of bins().
  size_t direct_entries() const { return bins() / 2; }
  // Maps "torque_x_NAME", "torque_y_NAME", "torque_z_NAME" [N m], signed, and the totals
  // "torque_x_NAME_body_N_m" and so on.
  Product product(const BinSums& sums) const override;

  // Requires at least two replicates.
  TorqueMap torque_map(const BinSums& sums) const;

  const std::string& name() const { return name_; }
  const SurfaceGrid& grid() const { return grid_; }
  const Vec3& about_body_m() const { return about_body_m_; }
  Force force() const { return force_; }

 private:
  std::string name_;
  SurfaceGrid grid_;
  Vec3 about_body_m_;
  Force force_;
  HitBinner binner_;
};

}  // namespace photorque
