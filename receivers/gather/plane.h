// A flat grid for gathering: the surface in every bin as pieces for integration, and the lamps over
// it. For the files of this folder only.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "raytrace/direct/irradiance_table.h"
#include "receivers/gather/lamp.h"
#include "receivers/surface_grid.h"

namespace photorque {

// A parallelogram origin + a·edge1 + b·edge2 with a, b in [0, 1]; with `triangle`, the half of it
// with a + b ≤ 1. Body frame.
struct SurfacePatch {
  Vec3 origin_m, edge1_m, edge2_m;
  double area_m2 = 0.0;
  uint32_t instance = 0;
  bool triangle = false;
};

// Patches in the order of the bins.
struct BinPatches {
  std::vector<SurfacePatch> patches;
  std::vector<uint32_t> first;  // bin b has patches first[b] … first[b + 1] − 1
  Vec3 point_m = Vec3::Zero();  // a point of the plane
  Vec3 normal = Vec3::UnitZ();  // normal of the surfaces' fronts

  // Patches of a bin.
  std::span<const SurfacePatch> of(size_t bin) const {
    return std::span(patches).subspan(first[bin], first[bin + 1] - first[bin]);
  }
};

// Whether the grid is over a plane and all its faces lie in one plane, to 1e-6 of the extent.
bool is_flat(const Scene& scene, const SurfaceGrid& grid);

// Pieces of a flat grid; a bin that one instance fills is a single parallelogram.
BinPatches bin_patches(const Scene& scene, const SurfaceGrid& grid);

// A rectangle of bins.
struct BinTile {
  int column, row, columns, rows;

  auto operator<=>(const BinTile&) const = default;
  int count() const { return columns * rows; }
  // Two halves of a tile of at least two bins.
  std::array<BinTile, 2> halves() const;
};

// Divides a grid into squares of at most 32 bins a side, of similar sizes: the items of parallel
// work.
std::vector<BinTile> squares_of(const SurfaceGrid& grid);

// One side of the flat surface under a grid. Body frame.
class GatherPlane {
 public:
  // `side` is front or back.
  GatherPlane(const TraceableScene& scene, const SurfaceGrid& grid, Side side);

  const TraceableScene& scene() const { return scene_; }
  const SurfaceGrid& grid() const { return grid_; }
  const Bands& bands() const { return scene_.scene().bands; }
  // Optical surface of an instance on this side.
  const OpticalSurface& surface(uint32_t instance) const {
    const Scene& scene = scene_.scene();
    return scene.surface(scene.instances[instance], side_ != Side::back);
  }
  const BinPatches& patches() const { return patches_; }
  const Vec3& normal() const { return patches_.normal; }  // of the lit side

  // The point at column + u, row + v of the grid of bins; (0, 0) is the corner of the first bin.
  Vec3 point_m(double column, double row) const {
    return corner_m_ + column * column_m_ + row * row_m_;
  }
  size_t bin_at(int column, int row) const { return grid_.bin_at(column, row); }
  // Ball that contains all bins of a tile.
  Ball ball_of(const BinTile& tile) const;
  // Whether the bin is one whole parallelogram of the grid.
  bool whole(size_t bin) const {
    const auto patches = patches_.of(bin);
    return patches.size() == 1 && !patches[0].triangle;
  }

 private:
  const TraceableScene& scene_;
  const SurfaceGrid& grid_;
  Side side_;
  BinPatches patches_;
  Vec3 corner_m_, column_m_, row_m_;
};

// One beam relative to the plane.
class GatherLamp : public PlacedLamp {
 public:
  // `light` belongs to the beam's emitter.
  GatherLamp(const Beam& beam, std::shared_ptr<const DiscLight> light,
             const RigidTransform& body_from_lab, const GatherPlane& plane);

  const Vec3& normal_emitter() const { return normal_emitter_; }  // of the lit side
  // Unshaded irradiance at a point of the plane.
  double irradiance_W_m2(const Vec3& at_body_m) const {
    return irradiance_at_W_m2(emitter_from_body().point(at_body_m));
  }
  // Fills the unshaded irradiance on a tile at the positions (column, row) in [0, 1]² of all pairs
  // of `fraction`.
  void fill_irradiance(const GatherPlane& plane, const BinTile& tile,
                       std::span<const double> fraction, Eigen::MatrixXd& W_m2) const;
  // Unshaded irradiance and momentum flow at a point of the plane, body frame.
  ArrivingLight arriving(const Vec3& at_body_m) const;
  // Error of irradiance_W_m2() due to the table; 0 without table.
  double table_error_W_m2() const { return table_ ? table_->error_W_m2() : 0.0; }
  // Unshaded power on a piece of the plane with these corners (body frame), see
  // DiscLight::power_through_W().
  Integral<double> power_W(std::span<const Vec3> corners_m, double tolerance_W) const;
  // Sets the table of the lamp's light, which must cover the heights of heights_m().
  void use(std::shared_ptr<const IrradianceTable> table) { table_ = std::move(table); }
  // Minimum and maximum height of the grid above the aperture.
  std::pair<double, double> heights_m(const GatherPlane& plane) const;
  // Positions along a straight line of the plane at which integrals of its light are divided, see
  // DiscLight::kinks_along(); the last is 1.
  std::vector<double> kinks_along(const Vec3& from_m, const Vec3& to_m) const;
  // Fractions of the second edge of a patch at which an integral over lines along its first edge is
  // divided; the last is 1.
  std::vector<double> kinks_across(const SurfacePatch& patch) const;
  // Whether every ray that meets the plane does so from the lit side (all but 1e-9 of the flux).
  bool lights_front() const { return lights_front_; }

  // Whether no ray of the beam reaches the ball from the lit side.
  bool misses(const Ball& ball) const;

 private:
  double irradiance_at_W_m2(const Vec3& at_m) const {  // emitter's frame
    return table_ ? table_->irradiance_W_m2(at_m, normal_emitter_)
                  : light().irradiance_W_m2(at_m, normal_emitter_);
  }

  std::shared_ptr<const IrradianceTable> table_;  // may be null
  Vec3 normal_emitter_;
  bool lights_front_ = false;
  double lean_rad_ = 0.0;  // angle between the axis and the direction into the plane
};

// A bin that may be in the shadow of something, for one lamp.
struct ShadedPair {
  uint32_t bin, lamp;
};

}  // namespace photorque
