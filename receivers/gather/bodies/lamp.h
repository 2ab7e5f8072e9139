// Light of one beam on the facets of a body. For the files of this folder only.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "raytrace/direct/irradiance_table.h"
#include "receivers/gather/bodies/facets.h"
#include "receivers/gather/lamp.h"

namespace photorque {

// Force and torque about a point, x, y and z of each.
using WrenchSum = Eigen::Array<double, 6, 1>;

// Force and its torque about a point, for the lever arm from that point.
WrenchSum wrench_of(const Vec3& force_N, const Vec3& lever_m);

// Light of an emitter, with tables of its momentum per slab of heights above the aperture. A table
// is computed when it is first needed.
class BodyLight {
 public:
  explicit BodyLight(std::shared_ptr<const DiscLight> light) : light_(std::move(light)) {}

  const std::shared_ptr<const DiscLight>& light() const { return light_; }
  // Announces the range of heights [m] of the body. Call it before table_at().
  void reach(double low_m, double high_m);
  // Null if there is no table for this height.
  const MomentumTable* table_at(double height_m) const;

 private:
  static constexpr double slab = 1.25;  // ratio of the heights of its ends
  struct Slab {
    std::once_flag made;
    std::optional<MomentumTable> table;
  };

  std::shared_ptr<const DiscLight> light_;
  double low_m_ = INFINITY, high_m_ = 0.0;
  std::vector<std::unique_ptr<Slab>> slabs_;
};

// Upper limit of the light of a beam on one side.
enum class Exposure {
  none,
  partly,  // some rays may come from behind
  whole,   // every ray that meets the facet meets this side (all but 1e-9 of the flux)
};

class BodyLamp : public PlacedLamp {
 public:
  // `of` must outlive this object.
  BodyLamp(const Beam& beam, const BodyLight& of, const RigidTransform& body_from_lab,
           const Bands& bands, double scene_diameter_m)
      : PlacedLamp(beam, of.light(), body_from_lab, bands, scene_diameter_m), table_(of) {}

  // Whether no part of the aperture is inside the ball.
  bool outside(const Ball& ball) const;
  Exposure exposure_of(const FacetSide& side) const;
  // Estimated power [W] on a facet.
  double typical_W(const FacetSide& side) const;
  // Unshaded irradiance and momentum flow at a point, body frame.
  ArrivingLight arriving(const Vec3& at_m, const Vec3& normal) const;
  // Unshaded wrench about a point of the light on a plain side that every ray meets, with the
  // errors of force and torque.
  struct Open {
    WrenchSum wrench;
    double force_error_N = 0.0, torque_error_N_m = 0.0;
  };
  Open open_wrench(const FacetSide& side, const FirstContact& contact, const Vec3& about_m) const;

 private:
  const BodyLight& table_;
};

}  // namespace photorque
